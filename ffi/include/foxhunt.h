/* foxhunt for C. Written by foxhunt-ffi-header, not by hand.
 *
 * All memory is the caller's: a type of foxhunt_sizes.h is storage, to be initialised by its `..._init` with its own size.
 * Nothing is allocated, nothing waits, and a program in which the library could panic does not link. A function that does
 * not return FOXHUNT_RESULT_OK has changed nothing.
 *
 * What is refused: null, pointers that are not aligned, storage of another size, storage that was not initialised or is of
 * another type, numbers that are out of range. What is up to the caller: that pointers lead to what they should, that those
 * of one call do not overlap, and that no two calls use the same storage at the same time. */

#ifndef FOXHUNT_H
#define FOXHUNT_H

#include <stddef.h>
#include <stdint.h>
#include "foxhunt_sizes.h"

/**
 * Messages are `$PFOXB` sentences: a value of `framing`.
 */
#define FOXHUNT_FRAMING_LINES 0

/**
 * Messages are binary frames: a value of `framing`.
 */
#define FOXHUNT_FRAMING_FRAMES 1

/**
 * All bearings have one bias in common: a value of `biases`.
 */
#define FOXHUNT_BIASES_COMMON 0

/**
 * Those of one station have one: a value of `biases`.
 */
#define FOXHUNT_BIASES_PER_STATION 1

/**
 * Those of one direction, as seen from the array, have one: a value of `biases`.
 */
#define FOXHUNT_BIASES_BY_DIRECTION 2

/**
 * Particles of a locator for clean bearings.
 */
#define FOXHUNT_PARTICLES 200

/**
 * Particles of a locator for bearings of which some are wrong.
 */
#define FOXHUNT_ROBUST_PARTICLES 256

/**
 * Bearings that a `FoxhuntClean`, a `FoxhuntRobust` or a gateway with one of them keeps. A `FoxhuntSeveral` keeps 64 for
 * each source, whatever this says, with 256 particles.
 */
#define FOXHUNT_BEARINGS 64

/**
 * The most sources of a locator of several.
 */
#define FOXHUNT_SOURCES 3

/**
 * Ports of a vehicle's gateway: a computer, a receiver and a direction finder, at any of them.
 */
#define FOXHUNT_PORTS 3

/**
 * Particles of the tracker of a tag.
 */
#define FOXHUNT_TAG_PARTICLES 300

/**
 * The most tags that a gateway tracks at once.
 */
#define FOXHUNT_TAGS 16

/**
 * The most beacons of a radio map.
 */
#define FOXHUNT_BEACONS 16

/**
 * The most points of a radio map.
 */
#define FOXHUNT_POINTS 1024

/**
 * Bearings count from the bow: a value of `reference`.
 */
#define FOXHUNT_REFERENCE_RELATIVE 0

/**
 * Bearings count from true north: a value of `reference`.
 */
#define FOXHUNT_REFERENCE_TRUE_NORTH 1

/**
 * Every direction finder is heard: a value of `finder`.
 */
#define FOXHUNT_FINDER_ALL 0

/**
 * An Agrelo: a value of `finder`.
 */
#define FOXHUNT_FINDER_AGRELO 1

/**
 * A KrakenSDR: a value of `finder`.
 */
#define FOXHUNT_FINDER_KRAKEN 2

/**
 * A u-blox board: a value of `finder`.
 */
#define FOXHUNT_FINDER_UBLOX 3

/**
 * A KN5R-RDF: a value of `finder`.
 */
#define FOXHUNT_FINDER_KN5R 4

/**
 * A direction finder that reports by APRS: a value of `finder`.
 */
#define FOXHUNT_FINDER_APRS 5

/**
 * What functions return: zero if all is well, else why nothing was done. State is then as before.
 */
enum FoxhuntResult
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * All is well.
   */
  FOXHUNT_RESULT_OK = 0,
  /**
   * A pointer is null.
   */
  FOXHUNT_RESULT_NULL_POINTER = 1,
  /**
   * A pointer is not aligned as its type must be.
   */
  FOXHUNT_RESULT_MISALIGNED = 2,
  /**
   * Storage has another size than in the library: `size` is not `sizeof` the type, or the header is of another version.
   */
  FOXHUNT_RESULT_SIZE = 3,
  /**
   * The locator, gateway or tracker was not initialised, or holds another type.
   */
  FOXHUNT_RESULT_UNINITIALISED = 4,
  /**
   * A field of a configuration is out of range: the function `..._config_fault` of the configuration names it.
   */
  FOXHUNT_RESULT_CONFIG = 5,
  /**
   * There is no such thing: no fix yet, or no more of them.
   */
  FOXHUNT_RESULT_NOTHING = 6,
  /**
   * The gateway has no such port.
   */
  FOXHUNT_RESULT_PORT = 7,
  /**
   * The generator was not initialised, or holds another type.
   */
  FOXHUNT_RESULT_NO_GENERATOR = 8,
  /**
   * The site was not initialised, or holds another type.
   */
  FOXHUNT_RESULT_NO_SITE = 9,
  /**
   * A position is not finite or too far from the origin.
   */
  FOXHUNT_RESULT_POSITION = 10,
  /**
   * A bearing is not finite.
   */
  FOXHUNT_RESULT_BEARING = 11,
  /**
   * A standard deviation is out of range.
   */
  FOXHUNT_RESULT_SIGMA = 12,
  /**
   * A bearing is older than all that are kept. The first of all sets the beginning: even the second may not be earlier.
   */
  FOXHUNT_RESULT_TOO_OLD = 13,
  /**
   * A bearing of this station and time was taken already.
   */
  FOXHUNT_RESULT_DUPLICATE = 14,
  /**
   * A heading is not finite.
   */
  FOXHUNT_RESULT_HEADING = 15,
  /**
   * A probability is not from 0 to 1.
   */
  FOXHUNT_RESULT_PROBABILITY = 16,
  /**
   * A covariance is none: an entry is not finite, or a variance would be negative.
   */
  FOXHUNT_RESULT_COVARIANCE = 17,
  /**
   * A map has fewer or more bytes than its header says.
   */
  FOXHUNT_RESULT_MAP_LENGTH = 20,
  /**
   * Bytes are not a map.
   */
  FOXHUNT_RESULT_MAP_MAGIC = 21,
  /**
   * A map is of another version.
   */
  FOXHUNT_RESULT_MAP_VERSION = 22,
  /**
   * The checksum of a map does not match.
   */
  FOXHUNT_RESULT_MAP_CHECKSUM = 23,
  /**
   * A map has another encoding than a tracker needs.
   */
  FOXHUNT_RESULT_MAP_ENCODING = 24,
  /**
   * A map has an impossible lattice.
   */
  FOXHUNT_RESULT_MAP_LATTICE = 25,
  /**
   * A map has no beacon, or more than there is room for.
   */
  FOXHUNT_RESULT_MAP_BEACONS = 26,
  /**
   * A map has more points than there is room for.
   */
  FOXHUNT_RESULT_MAP_POINTS = 27,
  /**
   * The header of a map is impossible.
   */
  FOXHUNT_RESULT_MAP_HEADER = 28,
  /**
   * The map has no such beacon.
   */
  FOXHUNT_RESULT_BEACON = 30,
  /**
   * No receiver can report such a strength.
   */
  FOXHUNT_RESULT_STRENGTH = 31,
  /**
   * A packet is older than the last update of its tag.
   */
  FOXHUNT_RESULT_OLD_PACKET = 32,
  /**
   * The workspace was not initialised, or holds another type.
   */
  FOXHUNT_RESULT_NO_WORKSPACE = 33,
  /**
   * What this library does not know by name.
   */
  FOXHUNT_RESULT_OTHER = 99,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum FoxhuntResult FoxhuntResult;
#else
typedef int32_t FoxhuntResult;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What a byte led to.
 */
enum FoxhuntBeaconEventKind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * It is in the middle of a message.
   */
  FOXHUNT_BEACON_EVENT_KIND_NONE = 0,
  /**
   * A packet of `tag` was taken, and waits for others.
   */
  FOXHUNT_BEACON_EVENT_KIND_TAKEN = 1,
  /**
   * A packet led to an update: `fix` of `tag`.
   */
  FOXHUNT_BEACON_EVENT_KIND_FIX = 2,
  /**
   * The message was not used: `rejected` says why.
   */
  FOXHUNT_BEACON_EVENT_KIND_REJECTED = 3,
  /**
   * The host has asked, and the report answers.
   */
  FOXHUNT_BEACON_EVENT_KIND_QUERIED = 4,
  /**
   * All tags were forgotten.
   */
  FOXHUNT_BEACON_EVENT_KIND_RESTARTED = 5,
  /**
   * A correct sentence of another kind, or one of a survey or of a new map, which C does not take.
   */
  FOXHUNT_BEACON_EVENT_KIND_OTHER = 6,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum FoxhuntBeaconEventKind FoxhuntBeaconEventKind;
#else
typedef uint32_t FoxhuntBeaconEventKind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Why the gateway of tags did not use a message.
 */
enum FoxhuntBeaconRejected
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * Checksum is wrong or missing.
   */
  FOXHUNT_BEACON_REJECTED_CHECKSUM = 0,
  /**
   * Message is too long.
   */
  FOXHUNT_BEACON_REJECTED_OVERLONG = 1,
  /**
   * Message cannot be parsed.
   */
  FOXHUNT_BEACON_REJECTED_UNPARSABLE = 2,
  /**
   * Value is out of range.
   */
  FOXHUNT_BEACON_REJECTED_OUT_OF_RANGE = 3,
  /**
   * Radio is not in the map.
   */
  FOXHUNT_BEACON_REJECTED_UNKNOWN_RADIO = 4,
  /**
   * Packet is too old.
   */
  FOXHUNT_BEACON_REJECTED_TOO_OLD = 5,
  /**
   * No tracker is free.
   */
  FOXHUNT_BEACON_REJECTED_NO_ROOM = 6,
  /**
   * Another reason.
   */
  FOXHUNT_BEACON_REJECTED_OTHER = 1000,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum FoxhuntBeaconRejected FoxhuntBeaconRejected;
#else
typedef uint32_t FoxhuntBeaconRejected;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How reliable the place of a tag is.
 */
enum FoxhuntTagState
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * It is where the fix says.
   */
  FOXHUNT_TAG_STATE_TRACKING = 0,
  /**
   * The fix is the mean of places too far apart.
   */
  FOXHUNT_TAG_STATE_UNCERTAIN = 1,
  /**
   * The evidence has gone against the particles, and some or all were just drawn anew.
   */
  FOXHUNT_TAG_STATE_LOST = 2,
  /**
   * It was lost, and the evidence has supported the particles since then, but not for long.
   */
  FOXHUNT_TAG_STATE_RECOVERED = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum FoxhuntTagState FoxhuntTagState;
#else
typedef uint32_t FoxhuntTagState;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What a locator knows, or why it does not: `foxhunt_answer_text` says it.
 */
enum FoxhuntAnswerKind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * There are fewer than two bearings: `have` of them.
   */
  FOXHUNT_ANSWER_KIND_TOO_FEW_BEARINGS = 0,
  /**
   * Where the source is.
   */
  FOXHUNT_ANSWER_KIND_FIX = 1,
  /**
   * The bearings cross at too small an angle: `have` and `needed` in radians.
   */
  FOXHUNT_ANSWER_KIND_CROSSING_ANGLE = 2,
  /**
   * The bearings do not meet in front of their receivers.
   */
  FOXHUNT_ANSWER_KIND_NO_INTERSECTION = 3,
  /**
   * Several places fit: `have` of them.
   */
  FOXHUNT_ANSWER_KIND_SEVERAL_PLACES = 4,
  /**
   * The range is not known well enough: `have` and `needed` are fractions of the range.
   */
  FOXHUNT_ANSWER_KIND_WIDE_RANGE = 5,
  /**
   * Most bearings do not fit the best place: `have` is the fraction of outliers.
   */
  FOXHUNT_ANSWER_KIND_CONTRADICTION = 6,
  /**
   * Another reason.
   */
  FOXHUNT_ANSWER_KIND_OTHER = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum FoxhuntAnswerKind FoxhuntAnswerKind;
#else
typedef uint32_t FoxhuntAnswerKind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What a byte led to.
 */
enum FoxhuntEventKind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * It is in the middle of a line.
   */
  FOXHUNT_EVENT_KIND_NONE = 0,
  /**
   * A sentence of the receiver was used.
   */
  FOXHUNT_EVENT_KIND_USED = 1,
  /**
   * A bearing was used: `answer` is a fix.
   */
  FOXHUNT_EVENT_KIND_FIX = 2,
  /**
   * A bearing was used: `answer` says why there is no fix yet.
   */
  FOXHUNT_EVENT_KIND_NOT_OBSERVABLE = 3,
  /**
   * The line was not used: `rejected` says why.
   */
  FOXHUNT_EVENT_KIND_REJECTED = 4,
  /**
   * The host has asked, and the report answers.
   */
  FOXHUNT_EVENT_KIND_QUERIED = 5,
  /**
   * The host looks for another source, and the report confirms it.
   */
  FOXHUNT_EVENT_KIND_RESTARTED = 6,
  /**
   * A correct sentence that is none of the gateway's.
   */
  FOXHUNT_EVENT_KIND_OTHER = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum FoxhuntEventKind FoxhuntEventKind;
#else
typedef uint32_t FoxhuntEventKind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Why the gateway of a vehicle did not use a line. The status sentence counts them in this order, from its seventh number on.
 */
enum FoxhuntRejected
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * Checksum is wrong or missing.
   */
  FOXHUNT_REJECTED_CHECKSUM = 0,
  /**
   * Line is too long.
   */
  FOXHUNT_REJECTED_OVERLONG = 1,
  /**
   * Line cannot be parsed.
   */
  FOXHUNT_REJECTED_UNPARSABLE = 2,
  /**
   * Receiver has no fix.
   */
  FOXHUNT_REJECTED_NO_FIX = 3,
  /**
   * Position is 0 degrees north and east.
   */
  FOXHUNT_REJECTED_NULL_POSITION = 4,
  /**
   * Time runs backwards.
   */
  FOXHUNT_REJECTED_TIME_BACKWARDS = 5,
  /**
   * Value is out of range.
   */
  FOXHUNT_REJECTED_OUT_OF_RANGE = 6,
  /**
   * No position yet: the first waits for a later one that agrees.
   */
  FOXHUNT_REJECTED_NO_POSITION = 7,
  /**
   * Position is too old.
   */
  FOXHUNT_REJECTED_STALE_POSITION = 8,
  /**
   * No heading: none is stated, and no course as the vehicle stands.
   */
  FOXHUNT_REJECTED_NO_HEADING = 9,
  /**
   * Vehicle is turning and its heading is unknown.
   */
  FOXHUNT_REJECTED_TURNING = 10,
  /**
   * Quality is too low.
   */
  FOXHUNT_REJECTED_LOW_QUALITY = 11,
  /**
   * Unexpected frequency.
   */
  FOXHUNT_REJECTED_OTHER_FREQUENCY = 12,
  /**
   * Unexpected tag.
   */
  FOXHUNT_REJECTED_OTHER_TAG = 13,
  /**
   * Unexpected direction finder.
   */
  FOXHUNT_REJECTED_OTHER_FINDER = 14,
  /**
   * Bearing is older than all that are kept.
   */
  FOXHUNT_REJECTED_TOO_OLD = 15,
  /**
   * Bearing was used already.
   */
  FOXHUNT_REJECTED_DUPLICATE = 16,
  /**
   * Position is simulated or entered by hand.
   */
  FOXHUNT_REJECTED_SIMULATED = 17,
  /**
   * Position waits for a later one that agrees.
   */
  FOXHUNT_REJECTED_UNCONFIRMED = 18,
  /**
   * Magnetic variation is unknown.
   */
  FOXHUNT_REJECTED_NO_VARIATION = 19,
  /**
   * Direction finder repeats its last spectrum: nothing is heard.
   */
  FOXHUNT_REJECTED_FROZEN = 20,
  /**
   * Unexpected anchor.
   */
  FOXHUNT_REJECTED_OTHER_ANCHOR = 21,
  /**
   * Another reason.
   */
  FOXHUNT_REJECTED_OTHER = 1000,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum FoxhuntRejected FoxhuntRejected;
#else
typedef uint32_t FoxhuntRejected;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How the gateway of a tunnel treats its messages.
 */
typedef struct FoxhuntBeaconConfig {
  /**
   * Seed of the particles: the same bytes with the same seed give the same reports.
   */
  uint64_t seed;
  /**
   * How messages come: `FOXHUNT_FRAMING_LINES` and so on.
   */
  uint32_t framing;
  /**
   * A radio that has heard nothing for so many milliseconds while others have, a second to an hour, is reported as silent.
   */
  uint32_t silence_ms;
} FoxhuntBeaconConfig;

/**
 * Text in the library: not ended by a zero. `printf("%.*s", (int)text.length, text.bytes)` prints it.
 */
typedef struct FoxhuntText {
  /**
   * The bytes: ASCII.
   */
  const char *bytes;
  /**
   * How many there are.
   */
  size_t length;
} FoxhuntText;

/**
 * What a byte led to. `foxhunt_beacon_fix` has the fix.
 */
typedef struct FoxhuntBeaconEvent {
  /**
   * What it is.
   */
  FoxhuntBeaconEventKind kind;
  /**
   * The reason, where `kind` says that it is a rejection: `foxhunt_beacon_rejected_text` says it. Elsewhere it says nothing.
   */
  FoxhuntBeaconRejected rejected;
  /**
   * The number of the tag.
   */
  uint32_t tag;
} FoxhuntBeaconEvent;

/**
 * A symmetric matrix of two rows, such as a covariance in square metres.
 */
typedef struct FoxhuntSymmetric2 {
  /**
   * The entry of the first row and column.
   */
  float xx;
  /**
   * Either entry off the diagonal.
   */
  float xy;
  /**
   * The entry of the second row and column.
   */
  float yy;
} FoxhuntSymmetric2;

/**
 * Where a tag is.
 */
typedef struct FoxhuntTagFix {
  /**
   * When it was there: the mean time of the packets of the last update, in milliseconds.
   */
  uint32_t time_ms;
  /**
   * How reliable the place is.
   */
  FoxhuntTagState state;
  /**
   * Posterior mean along the first axis of the map, in metres.
   */
  float x_m;
  /**
   * And along the second.
   */
  float y_m;
  /**
   * Posterior covariance in square metres.
   */
  struct FoxhuntSymmetric2 covariance;
  /**
   * Posterior mean of the velocity along the first axis, in metres a second.
   */
  float x_m_s;
  /**
   * And along the second.
   */
  float y_m_s;
  /**
   * By how many dB the tag reads stronger than the one of the survey.
   */
  float offset_db;
  /**
   * How many equally weighted particles the cloud is worth.
   */
  float effective_sample_size;
} FoxhuntTagFix;

/**
 * What a locator for clean bearings can be told.
 */
typedef struct FoxhuntCleanConfig {
  /**
   * Largest standard deviation of the range to the source that makes a fix, as a fraction of the range, 0.01 to 1.
   */
  float relative_range_sigma;
  /**
   * Particles are resampled and moved when the effective sample size falls below this fraction of their number, 0 to 1.
   */
  float resample_below;
  /**
   * Moves of every particle after a resampling, 1 to 16.
   */
  uint32_t moves;
} FoxhuntCleanConfig;

/**
 * A bearing on the source: where and when it was taken, by which station, and how far to trust it.
 */
typedef struct FoxhuntObservation {
  /**
   * When, in milliseconds from any origin. It may wrap.
   */
  uint32_t time_ms;
  /**
   * Where, in metres east of the origin, up to 1e6.
   */
  float east_m;
  /**
   * And in metres north of it.
   */
  float north_m;
  /**
   * Direction of the source in radians counter-clockwise from east: see `foxhunt_from_compass`.
   */
  float bearing_rad;
  /**
   * Standard deviation of the bearing in radians, 0.001 to 3.2.
   */
  float sigma_rad;
  /**
   * Where the array pointed, as the bearing; zero if that is of no interest.
   */
  float heading_rad;
  /**
   * Number of the antenna array.
   */
  uint8_t station;
  /**
   * Number of the frequency or tag that it was heard on.
   */
  uint8_t channel;
} FoxhuntObservation;

/**
 * A located source.
 */
typedef struct FoxhuntFix {
  /**
   * Posterior mean in metres east of the origin.
   */
  float east_m;
  /**
   * And in metres north of it.
   */
  float north_m;
  /**
   * Posterior covariance in square metres.
   */
  struct FoxhuntSymmetric2 covariance;
  /**
   * How many equally weighted particles the cloud is worth.
   */
  float effective_sample_size;
  /**
   * How many bearings the fix rests on.
   */
  uint32_t bearings;
} FoxhuntFix;

/**
 * What a locator knows of the source.
 */
typedef struct FoxhuntAnswer {
  /**
   * Whether there is a fix, or why not.
   */
  FoxhuntAnswerKind kind;
  /**
   * What there is, where there is no fix.
   */
  float have;
  /**
   * What is needed, where that is known.
   */
  float needed;
  /**
   * The fix, if there is one.
   */
  struct FoxhuntFix fix;
} FoxhuntAnswer;

/**
 * What a robust locator can be told. A zero switches a part of the errors off. `INFINITY` is a value.
 */
typedef struct FoxhuntRobustConfig {
  /**
   * Rate of direct bearings: what the other two leave of 1.
   */
  float direct;
  /**
   * Rate of mirrored bearings, 0 to 0.9.
   */
  float mirrored;
  /**
   * Rate of outliers, 0.001 to 0.9.
   */
  float outlier;
  /**
   * How many observed bearings the rates weigh as much as, at least 1. Infinity keeps them as they are.
   */
  float prior_bearings;
  /**
   * How many times as large as stated the standard deviations are, 0.1 to 10.
   */
  float sigma_scale;
  /**
   * Standard deviation of the natural logarithm of that scale before any bearing, 0 to 1.5; zero keeps the scale.
   */
  float scale_sigma;
  /**
   * Standard deviation of the error that bearings of one place have in common; radians, 0 to 1.
   */
  float stop_sigma_rad;
  /**
   * Standard deviation of the bias; radians, 0 to 0.5.
   */
  float bias_sigma_rad;
  /**
   * Which bearings have a bias in common: `FOXHUNT_BIASES_COMMON` and so on.
   */
  uint32_t biases;
  /**
   * Standard deviation of each coordinate of the places of bearings; metres, 0 to 1000.
   */
  float position_sigma_m;
  /**
   * Correlation of two bearings that are taken one after the other at one place, 0 to 0.999.
   */
  float correlation_at_rest;
  /**
   * It falls by a factor of e over this fraction of the range to the source, 0 to 1.
   */
  float correlation_distance;
  /**
   * And over so many metres, if that is farther, 0 to 1e6.
   */
  float correlation_distance_m;
  /**
   * And over this many seconds, at least 0.001.
   */
  float correlation_time_s;
  /**
   * Range from which on all orders of magnitude are as likely; metres, 0.01 to 1e6.
   */
  float nearest_m;
  /**
   * Range up to which they are, at least as large, up to 1e6.
   */
  float range_m;
  /**
   * Largest standard deviation of the range to the source that makes a fix, as a fraction of the range, 0.01 to 1.
   */
  float relative_range_sigma;
  /**
   * Particles are resampled and moved when the effective sample size falls below this fraction of their number, 0 to 1.
   */
  float resample_below;
  /**
   * Moves of every particle after a resampling, 1 to 16.
   */
  uint32_t moves;
} FoxhuntRobustConfig;

/**
 * A place where the source may be.
 */
typedef struct FoxhuntHypothesis {
  /**
   * Metres east of the origin.
   */
  float east_m;
  /**
   * Metres north of it.
   */
  float north_m;
  /**
   * Covariance in square metres, if this is the place.
   */
  struct FoxhuntSymmetric2 covariance;
  /**
   * Probability of this place among all.
   */
  float probability;
} FoxhuntHypothesis;

/**
 * What a locator of several sources can be told.
 */
typedef struct FoxhuntSeveralConfig {
  /**
   * What is believed of the bearings, and of a source at rest.
   */
  struct FoxhuntRobustConfig stationary;
  /**
   * Root mean square of the speed of the fastest source that is thought of, in metres a second, 0.05 to 100.
   */
  float speed_m_s;
  /**
   * The same of the slowest, at least 0.05 and at most as large.
   */
  float slowest_m_s;
  /**
   * Mean time for which a source is stationary, in seconds, 1 to 1e6.
   */
  float stationary_s;
  /**
   * Mean time for which it moves before it stops again, in seconds, 1 to 1e6.
   */
  float moving_s;
  /**
   * Mean time for which it moves straight on, in seconds, 1 to 1e5.
   */
  float straight_s;
  /**
   * Probability that outliers ever look like one more source, 1e-9 to 0.5.
   */
  float false_initiation;
  /**
   * Probability that a source is given up though it is still heard as often as before, 1e-9 to 0.5.
   */
  float false_deletion;
} FoxhuntSeveralConfig;

/**
 * One of several sources.
 */
typedef struct FoxhuntSource {
  /**
   * A number that it keeps for as long as it is tracked.
   */
  uint32_t identity;
  /**
   * Probability that there is such a source and that it is still heard.
   */
  float probability;
  /**
   * Where it is.
   */
  struct FoxhuntFix fix;
  /**
   * Probability that it moves now.
   */
  float moving;
  /**
   * If it moves: metres a second east.
   */
  float east_m_s;
  /**
   * And north.
   */
  float north_m_s;
  /**
   * Standard deviation of either.
   */
  float sigma_m_s;
} FoxhuntSource;

/**
 * How tags are tracked. `INFINITY` is a value.
 */
typedef struct FoxhuntTrackerConfig {
  /**
   * Standard deviation of a velocity along an axis when nothing is known of it, in metres a second: 0.01 to 100.
   */
  float velocity_sigma_m_s;
  /**
   * Variance that a velocity gains every second, in m^2/s^3: 0.0001 to 1000.
   */
  float velocity_noise_m2_s3;
  /**
   * Seconds in which a velocity falls to 1/e: at least 0.1; infinite for one that stays.
   */
  float velocity_memory_s;
  /**
   * Standard deviation in dB, 0.1 to 30, of the difference between a walk and the survey at one place.
   */
  float mismatch_sigma_db;
  /**
   * Seconds in which what a tag at rest remembers of the map's error falls to 1/e: at least 0.1.
   */
  float error_memory_s;
  /**
   * The power, 0.01 to 1, to which the likelihood of a scan of twelve beacons is raised.
   */
  float tempering;
  /**
   * Readings that differ by more than so many sigmas count as if they differed by that: at least 0.5; may be infinite.
   */
  float gate_sigmas;
  /**
   * The lowest strength in dBm that a radio can report, at least -128.
   */
  float lowest_dbm;
  /**
   * The highest, at least 10 dB above, at most 127.
   */
  float highest_dbm;
  /**
   * The probability, 0 to 0.99, that a tag reads otherwise than the one of the survey.
   */
  float offset_probability;
  /**
   * Standard deviation of its offset in that case, in dB: 0.1 to 50.
   */
  float offset_sigma_db;
  /**
   * Variance that an offset gains every second, in dB^2/s: 0 to 100.
   */
  float offset_noise_db2_s;
  /**
   * Packets of so many milliseconds, up to a minute, make one update; 0 for an update by every packet.
   */
  uint32_t window_ms;
  /**
   * Fraction of the particles, 0 to 1, that is drawn anew when the evidence has gone against them.
   */
  float redraw_fraction;
  /**
   * A place is uncertain when its standard deviation in the worst direction is larger than this, in metres.
   */
  float uncertain_sigma_m;
} FoxhuntTrackerConfig;

/**
 * How a gateway treats its lines. What the functions that fill it choose is in parentheses; what has none is zero.
 */
typedef struct FoxhuntLineConfig {
  /**
   * Seed of the particles: the same bytes with the same seed give the same reports (1).
   */
  uint64_t seed;
  /**
   * The frequencies that a KrakenSDR hears the sources on, which must stay as long as the gateway is used. Null with a
   * count of zero takes every frequency for one source.
   */
  const uint32_t *frequencies_hz;
  /**
   * How many there are.
   */
  size_t frequencies;
  /**
   * The only direction finder that is heard: `FOXHUNT_FINDER_ALL` and so on.
   */
  uint32_t finder;
  /**
   * Not zero: places and headings are used that a simulator made or that were entered by hand.
   */
  uint32_t simulated;
  /**
   * Direction from which bearings count that leave it open: `FOXHUNT_REFERENCE_RELATIVE` and so on.
   */
  uint32_t reference;
  /**
   * Not zero: the direction finders stand where the three next fields say.
   */
  uint32_t is_station;
  /**
   * Latitude of the station, in 1e-7 degree.
   */
  int32_t station_latitude_e7;
  /**
   * Longitude of the station, in 1e-7 degree.
   */
  int32_t station_longitude_e7;
  /**
   * Where relative bearings of 0 point, in degrees clockwise from true north, 0 to 360.
   */
  float station_heading_deg;
  /**
   * Quality, 0 to 100, below which a bearing is rejected (40).
   */
  float min_quality;
  /**
   * Standard deviation of a bearing of quality 100, at least 0.001 rad (2 degrees).
   */
  float best_sigma_rad;
  /**
   * Standard deviation of a bearing of quality 0, up to 3.2 rad (10 degrees).
   */
  float worst_sigma_rad;
  /**
   * Longest time between a bearing and its position or heading, up to an hour (2,000).
   */
  uint32_t max_age_ms;
  /**
   * How many bearings without a time are taken at one time of the receiver, up to 255 (20).
   */
  uint32_t undated_bearings;
  /**
   * Speed from which the course over ground is the heading (1.5).
   */
  float min_speed_m_s;
  /**
   * Rate of turn of the course above which it is not taken for the heading, up to 360 degrees a second (10).
   */
  float max_turn_rate_deg_s;
  /**
   * Speed that the vehicle never exceeds (100).
   */
  float max_speed_m_s;
  /**
   * Not zero: the variation of magnetic north is what the next field says.
   */
  uint32_t has_variation;
  /**
   * Degrees clockwise, -180 to 180.
   */
  float variation_deg;
  /**
   * Shortest time between two reports, up to an hour; 0 reports on every bearing (1,000).
   */
  uint32_t report_interval_ms;
} FoxhuntLineConfig;

/**
 * How the gateway of a vehicle works.
 */
typedef struct FoxhuntVehicleConfig {
  /**
   * How it treats its lines.
   */
  struct FoxhuntLineConfig lines;
  /**
   * What the locator is told.
   */
  struct FoxhuntCleanConfig locator;
} FoxhuntVehicleConfig;

/**
 * What a byte led to.
 */
typedef struct FoxhuntEvent {
  /**
   * What it is.
   */
  FoxhuntEventKind kind;
  /**
   * The reason, where `kind` says that it is a rejection: `foxhunt_rejected_text` says it. Elsewhere it says nothing.
   */
  FoxhuntRejected rejected;
  /**
   * What is known of the source, where a bearing was used; else it says nothing. In metres of a plane round where the
   * first bearing was taken: `foxhunt_vehicle_place` has latitude and longitude.
   */
  struct FoxhuntAnswer answer;
} FoxhuntEvent;

/**
 * A place on the Earth.
 */
typedef struct FoxhuntPlace {
  /**
   * Latitude in 1e-7 degree, north positive.
   */
  int32_t latitude_e7;
  /**
   * Longitude in 1e-7 degree, east positive.
   */
  int32_t longitude_e7;
} FoxhuntPlace;

/**
 * How the gateway of a vehicle with a robust locator works.
 */
typedef struct FoxhuntRobustVehicleConfig {
  /**
   * How it treats its lines.
   */
  struct FoxhuntLineConfig lines;
  /**
   * What the locator is told.
   */
  struct FoxhuntRobustConfig locator;
} FoxhuntRobustVehicleConfig;

/**
 * An ellipse in the plane.
 */
typedef struct FoxhuntEllipse {
  /**
   * Half of its longest diameter, in metres.
   */
  float semi_major_m;
  /**
   * Half of its shortest diameter, in metres.
   */
  float semi_minor_m;
  /**
   * Direction of the longest diameter in radians counter-clockwise from east.
   */
  float orientation_rad;
} FoxhuntEllipse;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Fills a configuration: sentences, and five seconds until a radio is silent.
 */
FoxhuntResult foxhunt_beacon_config_default(struct FoxhuntBeaconConfig *config);

/**
 * The name of the first field that is out of range, and what it may be; an empty text if all is right.
 */
struct FoxhuntText foxhunt_beacon_config_fault(const FoxhuntSite *site, const struct FoxhuntBeaconConfig *config);

/**
 * Why a message was rejected, by the number of the reason; an empty text of any other number.
 */
struct FoxhuntText foxhunt_beacon_rejected_text(uint32_t rejected);

/**
 * Makes a gateway without tags, with a copy of the site and of the configuration. `size` is `sizeof *beacon`. The bytes of
 * the map stay where they are.
 */
FoxhuntResult foxhunt_beacon_init(FoxhuntBeacon *beacon,
                                  size_t size,
                                  const FoxhuntSite *site,
                                  const struct FoxhuntBeaconConfig *config);

/**
 * Forgets all tags, and which radios are silent; keeps the counts.
 */
FoxhuntResult foxhunt_beacon_restart(FoxhuntBeacon *beacon);

/**
 * Takes the next byte of the line, and says what it led to; `event` may be null. Never waits.
 */
FoxhuntResult foxhunt_beacon_push(FoxhuntBeacon *beacon, uint8_t byte, struct FoxhuntBeaconEvent *event);

/**
 * What to send for the last message: sentences with their line ends, or nothing. It holds until the next call with this
 * gateway.
 */
struct FoxhuntText foxhunt_beacon_report(const FoxhuntBeacon *beacon);

/**
 * Where a tag is: `FOXHUNT_RESULT_NOTHING` if it is not tracked or has no fix yet.
 */
FoxhuntResult foxhunt_beacon_fix(const FoxhuntBeacon *beacon, uint32_t tag, struct FoxhuntTagFix *fix);

/**
 * Fills a configuration for a direction finder on a vehicle.
 */
FoxhuntResult foxhunt_clean_config_default(struct FoxhuntCleanConfig *config);

/**
 * The name of the first field that is out of range, and what it may be; an empty text if all is right.
 */
struct FoxhuntText foxhunt_clean_config_fault(const struct FoxhuntCleanConfig *config);

/**
 * Makes an empty locator, with a copy of the configuration. `size` is `sizeof *locator`.
 */
FoxhuntResult foxhunt_clean_init(FoxhuntClean *locator, size_t size, const struct FoxhuntCleanConfig *config);

/**
 * Forgets the source and its bearings.
 */
FoxhuntResult foxhunt_clean_reset(FoxhuntClean *locator);

/**
 * Takes a bearing, and says what is known with it; `answer` may be null.
 */
FoxhuntResult foxhunt_clean_push(FoxhuntClean *locator,
                                 const struct FoxhuntObservation *observation,
                                 FoxhuntGenerator *generator,
                                 struct FoxhuntAnswer *answer);

/**
 * What is known of the source.
 */
FoxhuntResult foxhunt_clean_answer(const FoxhuntClean *locator, struct FoxhuntAnswer *answer);

/**
 * The text of a result; that it is unknown, of any other number.
 */
struct FoxhuntText foxhunt_error_text(int32_t result);

/**
 * Fills a configuration for any direction finder, in a room or on a vehicle: a source a metre to 20 km away.
 */
FoxhuntResult foxhunt_robust_config_default(struct FoxhuntRobustConfig *config);

/**
 * Fills a configuration for a vehicle in a city.
 */
FoxhuntResult foxhunt_robust_config_city(struct FoxhuntRobustConfig *config);

/**
 * Fills a configuration for fixed arrays round a room.
 */
FoxhuntResult foxhunt_robust_config_room(struct FoxhuntRobustConfig *config);

/**
 * The name of the first field that is out of range, and what it may be; an empty text if all is right.
 */
struct FoxhuntText foxhunt_robust_config_fault(const struct FoxhuntRobustConfig *config);

/**
 * Makes an empty locator, with a copy of the configuration. `size` is `sizeof *locator`.
 */
FoxhuntResult foxhunt_robust_init(FoxhuntRobust *locator, size_t size, const struct FoxhuntRobustConfig *config);

/**
 * Forgets the source, its bearings and what they have taught.
 */
FoxhuntResult foxhunt_robust_reset(FoxhuntRobust *locator);

/**
 * Takes a bearing, and says what is known with it; `answer` may be null.
 */
FoxhuntResult foxhunt_robust_push(FoxhuntRobust *locator,
                                  const struct FoxhuntObservation *observation,
                                  FoxhuntGenerator *generator,
                                  struct FoxhuntAnswer *answer);

/**
 * What is known of the source.
 */
FoxhuntResult foxhunt_robust_answer(const FoxhuntRobust *locator, struct FoxhuntAnswer *answer);

/**
 * A place where the source may be, of up to four, before a fix, too: `FOXHUNT_RESULT_NOTHING` beyond the last index.
 */
FoxhuntResult foxhunt_robust_hypothesis(const FoxhuntRobust *locator,
                                        uint32_t index,
                                        struct FoxhuntHypothesis *hypothesis);

/**
 * Fills a configuration for sources in a city, of which any may drive off.
 */
FoxhuntResult foxhunt_several_config_city(struct FoxhuntSeveralConfig *config);

/**
 * The name of the first field that is out of range, and what it may be; an empty text if all is right.
 */
struct FoxhuntText foxhunt_several_config_fault(const struct FoxhuntSeveralConfig *config);

/**
 * Makes an empty locator, with a copy of the configuration. `size` is `sizeof *locator`.
 */
FoxhuntResult foxhunt_several_init(FoxhuntSeveral *locator, size_t size, const struct FoxhuntSeveralConfig *config);

/**
 * Forgets all sources and their bearings.
 */
FoxhuntResult foxhunt_several_reset(FoxhuntSeveral *locator);

/**
 * Takes a bearing, and says what is known with it of the best known source; `answer` may be null.
 */
FoxhuntResult foxhunt_several_push(FoxhuntSeveral *locator,
                                   const struct FoxhuntObservation *observation,
                                   FoxhuntGenerator *generator,
                                   struct FoxhuntAnswer *answer);

/**
 * The source of this index among those with a fix, the best known first: `FOXHUNT_RESULT_NOTHING` beyond the last.
 */
FoxhuntResult foxhunt_several_source(const FoxhuntSeveral *locator, uint32_t index, struct FoxhuntSource *source);

/**
 * Fills a configuration for people on foot, in the reach of a dozen radios.
 */
FoxhuntResult foxhunt_tracker_config_default(struct FoxhuntTrackerConfig *config);

/**
 * Fills a configuration for a tunnel: at any pace, past few radios.
 */
FoxhuntResult foxhunt_tracker_config_tunnel(struct FoxhuntTrackerConfig *config);

/**
 * The name of the first field that is out of range, and what it may be; an empty text if all is right.
 */
struct FoxhuntText foxhunt_tracker_config_fault(const struct FoxhuntTrackerConfig *config);

/**
 * Opens a radio map of `length` bytes, which are read in place: they must stay as they are as long as the site is used, and
 * may lie in flash. `size` is `sizeof *site`.
 */
FoxhuntResult foxhunt_site_init(FoxhuntSite *site,
                                size_t size,
                                const uint8_t *map,
                                size_t length,
                                const struct FoxhuntTrackerConfig *config);

/**
 * The number of the beacon with an identifier in the map; -1 if there is none.
 */
int32_t foxhunt_site_beacon(const FoxhuntSite *site, uint32_t identifier);

/**
 * Makes scratch memory. `size` is `sizeof *workspace`.
 */
FoxhuntResult foxhunt_workspace_init(FoxhuntWorkspace *workspace, size_t size);

/**
 * Makes a tracker without a tag. `size` is `sizeof *tracker`.
 */
FoxhuntResult foxhunt_tracker_init(FoxhuntTracker *tracker, size_t size);

/**
 * Forgets the tag.
 */
FoxhuntResult foxhunt_tracker_reset(FoxhuntTracker *tracker);

/**
 * Takes a packet with its time in milliseconds, which may wrap: the number of the beacon in the map, and the strength in
 * dBm. If it leads to an update, `updated` becomes 1, else 0, and the fix is written; `updated` and `fix` may be null.
 */
FoxhuntResult foxhunt_tracker_push(FoxhuntTracker *tracker,
                                   uint32_t time_ms,
                                   uint8_t beacon,
                                   float rssi_dbm,
                                   const FoxhuntSite *site,
                                   FoxhuntWorkspace *workspace,
                                   FoxhuntGenerator *generator,
                                   uint32_t *updated,
                                   struct FoxhuntTagFix *fix);

/**
 * Updates by the packets that wait, if there are any: at the end of a walk, or for a query.
 */
FoxhuntResult foxhunt_tracker_flush(FoxhuntTracker *tracker,
                                    const FoxhuntSite *site,
                                    FoxhuntWorkspace *workspace,
                                    FoxhuntGenerator *generator);

/**
 * Where the tag was at the last update: `FOXHUNT_RESULT_NOTHING` before the first.
 */
FoxhuntResult foxhunt_tracker_fix(const FoxhuntTracker *tracker, struct FoxhuntTagFix *fix);

/**
 * Why a line was rejected, by the number of the reason; an empty text of any other number.
 */
struct FoxhuntText foxhunt_rejected_text(uint32_t rejected);

/**
 * Fills a configuration for a car.
 */
FoxhuntResult foxhunt_vehicle_config_default(struct FoxhuntVehicleConfig *config);

/**
 * The name of the first field that is out of range, and what it may be; an empty text if all is right.
 */
struct FoxhuntText foxhunt_vehicle_config_fault(const struct FoxhuntVehicleConfig *config);

/**
 * Makes a gateway that knows nothing, with a copy of the configuration. `size` is `sizeof *vehicle`.
 */
FoxhuntResult foxhunt_vehicle_init(FoxhuntVehicle *vehicle, size_t size, const struct FoxhuntVehicleConfig *config);

/**
 * Forgets the source, to look for another; keeps the vehicle's own place and the counts.
 */
FoxhuntResult foxhunt_vehicle_restart(FoxhuntVehicle *vehicle);

/**
 * Takes the next byte of a port, 0 to `FOXHUNT_PORTS - 1`, and says what it led to; `event` may be null. Never waits.
 */
FoxhuntResult foxhunt_vehicle_push(FoxhuntVehicle *vehicle, uint32_t port, uint8_t byte, struct FoxhuntEvent *event);

/**
 * What to send for the last line: sentences with their line ends, or nothing. It holds until the next call with this
 * gateway.
 */
struct FoxhuntText foxhunt_vehicle_report(const FoxhuntVehicle *vehicle);

/**
 * Latitude and longitude of so many metres east and north of the origin, as a fix has them, up to 100 km:
 * `FOXHUNT_RESULT_NOTHING` before the first bearing.
 */
FoxhuntResult foxhunt_vehicle_place(const FoxhuntVehicle *vehicle,
                                    float east_m,
                                    float north_m,
                                    struct FoxhuntPlace *place);

/**
 * Fills a configuration for a car in a city.
 */
FoxhuntResult foxhunt_robust_vehicle_config_city(struct FoxhuntRobustVehicleConfig *config);

/**
 * The name of the first field that is out of range, and what it may be; an empty text if all is right.
 */
struct FoxhuntText foxhunt_robust_vehicle_config_fault(const struct FoxhuntRobustVehicleConfig *config);

/**
 * Makes a gateway that knows nothing, with a copy of the configuration. `size` is `sizeof *vehicle`.
 */
FoxhuntResult foxhunt_robust_vehicle_init(FoxhuntRobustVehicle *vehicle,
                                          size_t size,
                                          const struct FoxhuntRobustVehicleConfig *config);

/**
 * Forgets the source, to look for another; keeps the vehicle's own place and the counts.
 */
FoxhuntResult foxhunt_robust_vehicle_restart(FoxhuntRobustVehicle *vehicle);

/**
 * Takes the next byte of a port, 0 to `FOXHUNT_PORTS - 1`, and says what it led to; `event` may be null. Never waits.
 */
FoxhuntResult foxhunt_robust_vehicle_push(FoxhuntRobustVehicle *vehicle,
                                          uint32_t port,
                                          uint8_t byte,
                                          struct FoxhuntEvent *event);

/**
 * What to send for the last line: sentences with their line ends, or nothing. It holds until the next call with this
 * gateway.
 */
struct FoxhuntText foxhunt_robust_vehicle_report(const FoxhuntRobustVehicle *vehicle);

/**
 * Latitude and longitude of so many metres east and north of the origin, as a fix has them, up to 100 km:
 * `FOXHUNT_RESULT_NOTHING` before the first bearing.
 */
FoxhuntResult foxhunt_robust_vehicle_place(const FoxhuntRobustVehicle *vehicle,
                                           float east_m,
                                           float north_m,
                                           struct FoxhuntPlace *place);

/**
 * Seeds a generator. `size` is `sizeof *generator`.
 */
FoxhuntResult foxhunt_generator_init(FoxhuntGenerator *generator, size_t size, uint64_t seed);

/**
 * What a kind of answer says, without its numbers; an empty text of any other number.
 */
struct FoxhuntText foxhunt_answer_text(uint32_t kind);

/**
 * Radians counter-clockwise from east, of degrees clockwise from true north.
 */
float foxhunt_from_compass(float degrees);

/**
 * Degrees clockwise from true north, 0 to 360, of radians counter-clockwise from east.
 */
float foxhunt_to_compass(float radians);

/**
 * The ellipse that holds what has this covariance with a probability from 0 to 1, such as 0.95 for 95 %.
 */
FoxhuntResult foxhunt_ellipse(const struct FoxhuntSymmetric2 *covariance,
                              float probability,
                              struct FoxhuntEllipse *ellipse);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FOXHUNT_H */

FOXHUNT_ASSERT(sizeof(FoxhuntText) == FOXHUNT_TEXT_SIZE, "FoxhuntText has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntObservation) == FOXHUNT_OBSERVATION_SIZE, "FoxhuntObservation has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntSymmetric2) == FOXHUNT_SYMMETRIC2_SIZE, "FoxhuntSymmetric2 has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntFix) == FOXHUNT_FIX_SIZE, "FoxhuntFix has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntAnswer) == FOXHUNT_ANSWER_SIZE, "FoxhuntAnswer has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntHypothesis) == FOXHUNT_HYPOTHESIS_SIZE, "FoxhuntHypothesis has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntSource) == FOXHUNT_SOURCE_SIZE, "FoxhuntSource has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntEllipse) == FOXHUNT_ELLIPSE_SIZE, "FoxhuntEllipse has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntCleanConfig) == FOXHUNT_CLEAN_CONFIG_SIZE, "FoxhuntCleanConfig has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntRobustConfig) == FOXHUNT_ROBUST_CONFIG_SIZE, "FoxhuntRobustConfig has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntSeveralConfig) == FOXHUNT_SEVERAL_CONFIG_SIZE, "FoxhuntSeveralConfig has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntLineConfig) == FOXHUNT_LINE_CONFIG_SIZE, "FoxhuntLineConfig has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntVehicleConfig) == FOXHUNT_VEHICLE_CONFIG_SIZE, "FoxhuntVehicleConfig has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntRobustVehicleConfig) == FOXHUNT_ROBUST_VEHICLE_CONFIG_SIZE, "FoxhuntRobustVehicleConfig has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntEvent) == FOXHUNT_EVENT_SIZE, "FoxhuntEvent has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntPlace) == FOXHUNT_PLACE_SIZE, "FoxhuntPlace has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntTrackerConfig) == FOXHUNT_TRACKER_CONFIG_SIZE, "FoxhuntTrackerConfig has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntTagFix) == FOXHUNT_TAG_FIX_SIZE, "FoxhuntTagFix has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntBeaconConfig) == FOXHUNT_BEACON_CONFIG_SIZE, "FoxhuntBeaconConfig has another size");
FOXHUNT_ASSERT(sizeof(FoxhuntBeaconEvent) == FOXHUNT_BEACON_EVENT_SIZE, "FoxhuntBeaconEvent has another size");
