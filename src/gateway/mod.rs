//! The serial gateway: bytes in, fixes out, without input or output of its own.
//!
//! A [`Vehicle`] takes bytes on numbered ports, one for each line that a navigation receiver, a direction finder or a host
//! talks on; they may share one, too. It tells what each line led to. It is the same state machine in firmware, on a desk
//! and in tests: it holds no clock, every time is one that the lines state, so a replay of the bytes gives the same
//! answers to the last bit. [`Gateway`] is a `Vehicle` with its [`Config`], for short programs.
//!
//! # Lines in
//!
//! Ended by CR, LF or both.
//!
//! | line | format | what is taken from it |
//! |---|---|---|
//! | `$--RMC` `$--GGA` | [`Nmea`](formats::Nmea) | time and position; RMC also speed and course over ground, and variation |
//! | `$--VTG` | | speed and course over ground |
//! | `$--HDT` `$--THS` `$PASHR` `$PTNTHTM` | | true heading |
//! | `$--HDG` `$--HDM` | | magnetic heading, HDG with the error of the compass and the variation |
//! | `$PFOXQ*50` | | a query: the answer and the status are sent whenever they were sent last |
//! | `$PFOXR*53` | | a restart, to look for another source: [`Vehicle::restart`] |
//! | `B5 62 01 07 ...` | [`Ubx`](formats::Ubx) | a binary frame `NAV-PVT` of a u-blox receiver: time, position, speed, course; heading and variation if valid |
//! | that of a direction finder | its own | see [`Finder`](formats::Finder): bearing and quality; time, place and heading if the line has them |
//!
//! [`formats::All`] reads them all. Firmware that names fewer, such as `Vehicle<L, (Nmea, Agrelo)>`, links no others.
//! The settings of a format are in its `Config`: of several frequencies or tags one may be the source's. What the builds
//! of the KrakenSDR's software do not agree on is recognised, or configured.
//!
//! Every NMEA sentence must carry its checksum. `$` begins one anywhere, so that what comes before costs none; blanks at the
//! end of a line do not count. Correct sentences of other kinds are left to others, by [`Event::Other`];
//! everything else that is not used is counted by its reason, [`Rejected`], and has no effect on the locator.
//!
//! A position is believed if the vehicle can have got there from the last one by [`Config::max_speed_m_s`]. The first after
//! a start or an outage and one that is too far away wait for the next of another time that agrees: a checksum of eight bits
//! lets one in 256 damaged sentences pass. Bearings that are taken where the vehicle cannot be wait likewise, and begin
//! another search if they go on: see [`Vehicle::plane`]. A sentence that states no time has that of the last one that does; after one
//! that was refused it has none. Magnetic headings need a variation: [`Config::variation_deg`], else that which HDG, RMC or
//! `NAV-PVT` states.
//!
//! A bearing belongs to where the vehicle was when it was taken: the time of a KrakenSDR's line less half the
//! latency that it states. Place and heading are those between the two samples about that time, or as they went on from the last two,
//! if samples are fresh by the times that both state (the clock of a direction finder that states times must therefore be
//! right; a bearing that states none is taken at the receiver's time, but only so often: see
//! [`Config::undated_bearings`]). An outage of the receiver is not bridged. The locator gets one clock, in milliseconds
//! that run on over midnight, and the number of the port for the station.
//!
//! What a bearing counts from is told by [`Config::reference`], unless its format says so: a report of APRS counts from north.
//! A relative bearing needs a heading: that of its own line, else a fresh true heading, else the course of a vehicle that
//! is fast enough and does not turn. What the heading of a KrakenSDR by its GPS is worth is judged by its motion: see
//! [`Heading`](formats::kraken::Heading). [`Config::station`] holds for whatever does not move. The quality decides
//! on the standard deviation: see [`Config::best_sigma_rad`] and, by a table for each device, [`SigmaTable`].
//!
//! # Lines out
//!
//! Sentences with a checksum, ended by CR and LF. One `$PFOXF` or `$PFOXN` after an accepted bearing, if the last is at
//! least [`Config::report_interval_ms`] old; one of them and a `$PFOXS` for a query: when they come, all bytes that were
//! sent before the query on that port have been processed; a `$PFOXN` for a restart. This is a [`ShortReport`]. A
//! [`FullReport`] says all that a locator knows, in sentences that follow, of up to four sources and four hypotheses.
//!
//! **`$PFOXF,hhmmss.sss,ddmm.mmmmmm,N,dddmm.mmmmmm,E,major,minor,orientation,bearings,ess*hh`**, a fix:
//! UTC time of the last bearing; latitude and longitude of the source, to 1e-7 degree; standard deviations, in
//! metres, along the longer and the shorter axis of its uncertainty (times 2.448: the 95 % ellipse); the
//! direction of the longer axis, in degrees clockwise from north within 0 and 180; how many bearings it rests
//! on; the effective sample size of the particles.
//!
//! **`$PFOXN,hhmmss.sss,reason,bearings,has,needs*hh`**, no fix yet: the time of the last bearing, empty if
//! there was none; the reason; how many bearings there were since the last restart, for `RANGE` those of that source; what
//! there is and what is needed, both empty for most reasons. The reasons are those of
//! [`NotObservable`](crate::aoa::NotObservable), and `RANGE`:
//!
//! | reason | means | has | needs |
//! |---|---|---|---|
//! | `FEW` | fewer than two bearings | | |
//! | `ANGLE` | the bearings are too nearly parallel | the angle at which they cross, in degrees | the least that makes a fix |
//! | `APART` | the bearings do not meet in front of their receivers | | |
//! | `PLACES` | several places fit | | |
//! | `WIDE` | the range is not known well enough | standard deviation of the place, in percent of the range | the largest that makes a fix |
//! | `CONTRARY` | most bearings are outliers at the best place | | |
//! | `RANGE` | in the place of a source's `$PFOXF`: it is further from the origin than [`MAX_RANGE_M`](crate::aoa::geodesy::LocalPlane::MAX_RANGE_M) | | |
//!
//! **`$PFOXM,source,moving,speed,course,sigma,probability*hh`** after a `$PFOXF` of a source that may move, or of one of several,
//! each of which has a `$PFOXF` of its own, the best known first: the number of the source; the probability, in percent,
//! that it moves; and if so its speed in metres a second, its course in degrees clockwise from north, and the standard
//! deviation of either component of its velocity; the probability, in percent, that there is such a source and that it is still
//! heard. Without a `$PFOXM` it is source 0.
//!
//! **`$PFOXC,ddmm.mmmmmm,N,dddmm.mmmmmm,E,major,minor,orientation,probability*hh`** after the last source: a place where one
//! more source may be, if that is likely enough to look there, and its probability in percent.
//!
//! **`$PFOXH,ddmm.mmmmmm,N,dddmm.mmmmmm,E,major,minor,orientation,probability*hh`** after a `$PFOXN`: a place where the
//! source may be, as that of a fix, and its probability in percent among all such places, of which there are up to four.
//! Before the bearings cross (`FEW`, `ANGLE`), the range of such a place means nothing, only its direction does.
//!
//! **`$PFOXA,course,metres,information*hh`** after these, advice to the driver: the course, in degrees clockwise from
//! north, on which the next bearings are expected to tell most; how far to go there until they cross at a sufficient angle,
//! empty where that is too far; what a bearing from there is expected to tell, in nats.
//! See [`Advice`](crate::aoa::Advice).
//!
//! **`$PFOXE,bias,sigma,direct,mirrored,outlier*hh`**, at the end, what is known of the errors of the bearings: by how many
//! degrees all of them are too far clockwise, and the standard deviation of that, both empty before the first fix; the
//! rates of direct, mirrored and outlier bearings in percent.
//!
//! **`$PFOXS,lines,sentences,bearings,ignored,queries,restarts,...*hh`**, the status: the counts of [`Counters`] and then,
//! in the order of [`Rejected::ALL`], of every reason for a rejection. The first is the sum of all others.

pub mod beacon;
mod clock;
mod config;
pub mod formats;
mod history;
#[cfg(feature = "embedded-io")]
pub mod io;
mod line;
mod navigation;
mod outcome;
mod record;
mod report;
mod search;
mod sentence;
mod sigma;
mod vehicle;

pub use config::{BearingReference, Config};
pub use formats::format::Station;
pub use history::Aged;
pub use navigation::Receiver;
pub use outcome::{Counters, Event, Rejected};
pub use record::BearingRecord;
pub use report::{FullReport, ReportForm, ShortReport};
pub use sigma::SigmaTable;
pub use vehicle::{Gateway, Vehicle};
