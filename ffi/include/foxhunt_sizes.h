/* The sizes of foxhunt's types. Written by foxhunt-ffi-header, not by hand.
 *
 * The library for each machine checks them again when storage is initialised. */

#ifndef FOXHUNT_SIZES_H
#define FOXHUNT_SIZES_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define FOXHUNT_ASSERT(holds, text) static_assert(holds, text)
#define FOXHUNT_ALIGNMENT(type) alignof(type)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define FOXHUNT_ASSERT(holds, text) _Static_assert(holds, text)
#define FOXHUNT_ALIGNMENT(type) _Alignof(type)
#else
/* C99 has neither. */
#define FOXHUNT_ASSERT(holds, text) extern const char foxhunt_assert[(holds) ? 1 : -1]
#define FOXHUNT_ALIGNMENT(type) offsetof(struct { char first; type second; }, second)
#endif

#if UINTPTR_MAX == 0xFFFFFFFFu
#define FOXHUNT_GENERATOR_SIZE 40u
#define FOXHUNT_CLEAN_SIZE 6368u
#define FOXHUNT_ROBUST_SIZE 10016u
#define FOXHUNT_SEVERAL_SIZE 62560u
#define FOXHUNT_VEHICLE_SIZE 9200u
#define FOXHUNT_ROBUST_VEHICLE_SIZE 13712u
#define FOXHUNT_SITE_SIZE 152u
#define FOXHUNT_TRACKER_SIZE 2064u
#define FOXHUNT_WORKSPACE_SIZE 31200u
#define FOXHUNT_BEACON_SIZE 75568u
#define FOXHUNT_TEXT_SIZE 8u
#define FOXHUNT_OBSERVATION_SIZE 28u
#define FOXHUNT_SYMMETRIC2_SIZE 12u
#define FOXHUNT_FIX_SIZE 28u
#define FOXHUNT_ANSWER_SIZE 40u
#define FOXHUNT_HYPOTHESIS_SIZE 24u
#define FOXHUNT_SOURCE_SIZE 52u
#define FOXHUNT_ELLIPSE_SIZE 12u
#define FOXHUNT_CLEAN_CONFIG_SIZE 12u
#define FOXHUNT_ROBUST_CONFIG_SIZE 76u
#define FOXHUNT_SEVERAL_CONFIG_SIZE 104u
#define FOXHUNT_LINE_CONFIG_SIZE 88u
#define FOXHUNT_VEHICLE_CONFIG_SIZE 104u
#define FOXHUNT_ROBUST_VEHICLE_CONFIG_SIZE 168u
#define FOXHUNT_EVENT_SIZE 48u
#define FOXHUNT_PLACE_SIZE 8u
#define FOXHUNT_TRACKER_CONFIG_SIZE 60u
#define FOXHUNT_TAG_FIX_SIZE 44u
#define FOXHUNT_BEACON_CONFIG_SIZE 16u
#define FOXHUNT_BEACON_EVENT_SIZE 12u
#else
#define FOXHUNT_GENERATOR_SIZE 40u
#define FOXHUNT_CLEAN_SIZE 6368u
#define FOXHUNT_ROBUST_SIZE 10024u
#define FOXHUNT_SEVERAL_SIZE 62656u
#define FOXHUNT_VEHICLE_SIZE 9272u
#define FOXHUNT_ROBUST_VEHICLE_SIZE 13792u
#define FOXHUNT_SITE_SIZE 192u
#define FOXHUNT_TRACKER_SIZE 2064u
#define FOXHUNT_WORKSPACE_SIZE 31200u
#define FOXHUNT_BEACON_SIZE 75616u
#define FOXHUNT_TEXT_SIZE 16u
#define FOXHUNT_OBSERVATION_SIZE 28u
#define FOXHUNT_SYMMETRIC2_SIZE 12u
#define FOXHUNT_FIX_SIZE 28u
#define FOXHUNT_ANSWER_SIZE 40u
#define FOXHUNT_HYPOTHESIS_SIZE 24u
#define FOXHUNT_SOURCE_SIZE 52u
#define FOXHUNT_ELLIPSE_SIZE 12u
#define FOXHUNT_CLEAN_CONFIG_SIZE 12u
#define FOXHUNT_ROBUST_CONFIG_SIZE 76u
#define FOXHUNT_SEVERAL_CONFIG_SIZE 104u
#define FOXHUNT_LINE_CONFIG_SIZE 96u
#define FOXHUNT_VEHICLE_CONFIG_SIZE 112u
#define FOXHUNT_ROBUST_VEHICLE_CONFIG_SIZE 176u
#define FOXHUNT_EVENT_SIZE 48u
#define FOXHUNT_PLACE_SIZE 8u
#define FOXHUNT_TRACKER_CONFIG_SIZE 60u
#define FOXHUNT_TAG_FIX_SIZE 44u
#define FOXHUNT_BEACON_CONFIG_SIZE 16u
#define FOXHUNT_BEACON_EVENT_SIZE 12u
#endif

/** See the functions that take it. May be copied, but not while it is used. */
typedef struct FoxhuntGenerator {
  uint64_t storage[FOXHUNT_GENERATOR_SIZE / 8u];
} FoxhuntGenerator;
FOXHUNT_ASSERT(sizeof(FoxhuntGenerator) == FOXHUNT_GENERATOR_SIZE, "FoxhuntGenerator has another size");
FOXHUNT_ASSERT(FOXHUNT_ALIGNMENT(FoxhuntGenerator) == 8, "FoxhuntGenerator is aligned otherwise");

/** See the functions that take it. May be copied, but not while it is used. */
typedef struct FoxhuntClean {
  uint64_t storage[FOXHUNT_CLEAN_SIZE / 8u];
} FoxhuntClean;
FOXHUNT_ASSERT(sizeof(FoxhuntClean) == FOXHUNT_CLEAN_SIZE, "FoxhuntClean has another size");
FOXHUNT_ASSERT(FOXHUNT_ALIGNMENT(FoxhuntClean) == 8, "FoxhuntClean is aligned otherwise");

/** See the functions that take it. May be copied, but not while it is used. */
typedef struct FoxhuntRobust {
  uint64_t storage[FOXHUNT_ROBUST_SIZE / 8u];
} FoxhuntRobust;
FOXHUNT_ASSERT(sizeof(FoxhuntRobust) == FOXHUNT_ROBUST_SIZE, "FoxhuntRobust has another size");
FOXHUNT_ASSERT(FOXHUNT_ALIGNMENT(FoxhuntRobust) == 8, "FoxhuntRobust is aligned otherwise");

/** See the functions that take it. May be copied, but not while it is used. */
typedef struct FoxhuntSeveral {
  uint64_t storage[FOXHUNT_SEVERAL_SIZE / 8u];
} FoxhuntSeveral;
FOXHUNT_ASSERT(sizeof(FoxhuntSeveral) == FOXHUNT_SEVERAL_SIZE, "FoxhuntSeveral has another size");
FOXHUNT_ASSERT(FOXHUNT_ALIGNMENT(FoxhuntSeveral) == 8, "FoxhuntSeveral is aligned otherwise");

/** See the functions that take it. May be copied, but not while it is used. */
typedef struct FoxhuntVehicle {
  uint64_t storage[FOXHUNT_VEHICLE_SIZE / 8u];
} FoxhuntVehicle;
FOXHUNT_ASSERT(sizeof(FoxhuntVehicle) == FOXHUNT_VEHICLE_SIZE, "FoxhuntVehicle has another size");
FOXHUNT_ASSERT(FOXHUNT_ALIGNMENT(FoxhuntVehicle) == 8, "FoxhuntVehicle is aligned otherwise");

/** See the functions that take it. May be copied, but not while it is used. */
typedef struct FoxhuntRobustVehicle {
  uint64_t storage[FOXHUNT_ROBUST_VEHICLE_SIZE / 8u];
} FoxhuntRobustVehicle;
FOXHUNT_ASSERT(sizeof(FoxhuntRobustVehicle) == FOXHUNT_ROBUST_VEHICLE_SIZE, "FoxhuntRobustVehicle has another size");
FOXHUNT_ASSERT(FOXHUNT_ALIGNMENT(FoxhuntRobustVehicle) == 8, "FoxhuntRobustVehicle is aligned otherwise");

/** See the functions that take it. May be copied, but not while it is used. */
typedef struct FoxhuntSite {
  uint64_t storage[FOXHUNT_SITE_SIZE / 8u];
} FoxhuntSite;
FOXHUNT_ASSERT(sizeof(FoxhuntSite) == FOXHUNT_SITE_SIZE, "FoxhuntSite has another size");
FOXHUNT_ASSERT(FOXHUNT_ALIGNMENT(FoxhuntSite) == 8, "FoxhuntSite is aligned otherwise");

/** See the functions that take it. May be copied, but not while it is used. */
typedef struct FoxhuntTracker {
  uint64_t storage[FOXHUNT_TRACKER_SIZE / 8u];
} FoxhuntTracker;
FOXHUNT_ASSERT(sizeof(FoxhuntTracker) == FOXHUNT_TRACKER_SIZE, "FoxhuntTracker has another size");
FOXHUNT_ASSERT(FOXHUNT_ALIGNMENT(FoxhuntTracker) == 8, "FoxhuntTracker is aligned otherwise");

/** See the functions that take it. May be copied, but not while it is used. */
typedef struct FoxhuntWorkspace {
  uint64_t storage[FOXHUNT_WORKSPACE_SIZE / 8u];
} FoxhuntWorkspace;
FOXHUNT_ASSERT(sizeof(FoxhuntWorkspace) == FOXHUNT_WORKSPACE_SIZE, "FoxhuntWorkspace has another size");
FOXHUNT_ASSERT(FOXHUNT_ALIGNMENT(FoxhuntWorkspace) == 8, "FoxhuntWorkspace is aligned otherwise");

/** See the functions that take it. May be copied, but not while it is used. */
typedef struct FoxhuntBeacon {
  uint64_t storage[FOXHUNT_BEACON_SIZE / 8u];
} FoxhuntBeacon;
FOXHUNT_ASSERT(sizeof(FoxhuntBeacon) == FOXHUNT_BEACON_SIZE, "FoxhuntBeacon has another size");
FOXHUNT_ASSERT(FOXHUNT_ALIGNMENT(FoxhuntBeacon) == 8, "FoxhuntBeacon is aligned otherwise");

#endif
