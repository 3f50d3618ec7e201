//! What foxhunt is checked with on a desk.
//!
//! The library answers in f32 with a few hundred particles. Here are the same questions answered in
//! f64 with everything a desk has:
//!
//! - [`tracks`]: the problems of the published experiments, ready made;
//! - [`experiment`]: the walk of the published experiment through a tunnel;
//! - [`radio_map`]: from the readings of a survey to a radio map in flash;
//! - [`tetam`]: a survey and walks measured in an office floor; [`walks`]: those, and simulated ones, tracked;
//! - [`building`]: a building of several floors, its survey and walks through it;
//! - [`robot`]: a survey and a drive of a robot in a flat;
//! - [`simulate`]: noisy bearings along a track; [`stationary`]: those of a vehicle at rest; [`drive`]: a whole drive
//!   of a vehicle, as the bytes that its receiver and its direction finder put on the line;
//! - [`accuracy`]: the largest error of each function of `foxhunt::math`;
//! - [`mod@reference`]: exact answers, to measure the library against;
//! - [`mod@array`]: an antenna array among reflections, and the spectra that a direction finder makes of it;
//! - [`passes`]: drives past a source with it;
//! - [`stops`]: a vehicle that takes many readings at each stop; [`stations`]: arrays round a room, each with a bias;
//!   [`xplr`]: such arrays, measured; [`curve`]: a bias by direction;
//! - [`channel`]: several sources on one channel;
//! - [`scripts`]: drives on which something happens;
//! - [`measured`]: bearings from the field, turned into such bytes;
//! - [`replay`]: those bytes through the library's gateway, as the firmware does it;
//! - [`packets`]: what the radios of a tunnel hear, as bytes on their line, and through the library's gateway;
//! - [`damage`]: damaged lines of real receivers, and what is believed of them;
//! - [`geodesy`]: places on the ellipsoid;
//! - [`picture`]: all of it in one picture; [`figures`]: what was measured, with its limit.

pub mod accuracy;
pub mod archive;
pub mod array;
pub mod building;
pub mod channel;
pub mod curve;
pub mod damage;
pub mod density;
pub mod drive;
pub mod experiment;
pub mod figures;
pub mod geodesy;
pub mod measured;
pub mod packets;
pub mod passes;
pub mod picture;
pub mod radio_map;
pub mod reference;
pub mod replay;
pub mod robot;
pub mod scripts;
pub mod simulate;
pub mod stationary;
pub mod stations;
pub mod stops;
pub mod tetam;
pub mod tracks;
pub mod walker;
pub mod walks;
pub mod xplr;
