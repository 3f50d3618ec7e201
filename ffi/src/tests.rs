//! What C does with the library, for an interpreter that finds undefined behaviour: `cargo xtask release behaviour`. What the
//! door refuses, and what comes out, is tested in C.

use std::mem::MaybeUninit;

use crate::door;
use crate::result::{FoxhuntResult, FoxhuntText};
use crate::{clean::*, tracker::*, vehicle::*, words::*};

/// Storage as C has it: of zeros.
struct Storage<T>(Box<MaybeUninit<T>>);

impl<T> Storage<T> {
    const SIZE: usize = size_of::<T>();

    fn new() -> Self {
        Self(Box::new(MaybeUninit::zeroed()))
    }

    fn pointer(&mut self) -> *mut T {
        self.0.as_mut_ptr()
    }
}

fn ok(result: FoxhuntResult) {
    assert_eq!(result, FoxhuntResult::Ok);
}

fn generator() -> Storage<FoxhuntGenerator> {
    let mut generator = Storage::new();
    ok(foxhunt_generator_init(
        generator.pointer(),
        Storage::<FoxhuntGenerator>::SIZE,
        7,
    ));
    generator
}

fn text(text: FoxhuntText) -> String {
    let bytes = door::list(text.bytes.cast::<u8>(), text.length);
    String::from_utf8(bytes.unwrap().to_vec()).unwrap()
}

#[test]
fn what_is_no_storage_is_refused() {
    let mut bytes: Vec<u64> = vec![0; Storage::<FoxhuntClean>::SIZE / 8 + 1];
    let mut config = Storage::<FoxhuntCleanConfig>::new();
    ok(foxhunt_clean_config_default(config.pointer()));
    let pointer = bytes.as_mut_ptr().cast::<FoxhuntClean>();
    let init = |pointer, size| foxhunt_clean_init(pointer, size, config.0.as_ptr());
    let size = Storage::<FoxhuntClean>::SIZE;
    assert_eq!(foxhunt_clean_reset(pointer), FoxhuntResult::Uninitialised);
    let crooked = pointer.wrapping_byte_add(4);
    assert_eq!(init(crooked, size), FoxhuntResult::Misaligned);
    assert_eq!(init(pointer, size - 8), FoxhuntResult::Size);
    assert_eq!(init(std::ptr::null_mut(), size), FoxhuntResult::NullPointer);
    ok(init(pointer, size));
    ok(foxhunt_clean_reset(pointer));
    let other = pointer.cast::<FoxhuntGenerator>();
    assert_eq!(draw(other, |_| ()).err(), Some(FoxhuntResult::NoGenerator));
}

#[test]
fn bearings_come_in_and_answers_go_out() {
    let mut locator = Storage::<FoxhuntClean>::new();
    let mut config = Storage::<FoxhuntCleanConfig>::new();
    let mut generator = generator();
    ok(foxhunt_clean_config_default(config.pointer()));
    ok(foxhunt_clean_init(
        locator.pointer(),
        Storage::<FoxhuntClean>::SIZE,
        config.pointer(),
    ));
    for step in 0..3_u8 {
        let observation = FoxhuntObservation {
            time_ms: 1_000 * u32::from(step),
            east_m: 300.0 * f32::from(step),
            north_m: 0.0,
            bearing_rad: 500.0_f32.atan2(400.0 - 300.0 * f32::from(step)),
            sigma_rad: 0.05,
            heading_rad: 0.0,
            station: 0,
            channel: 0,
        };
        let generator = generator.pointer();
        let nowhere = std::ptr::null_mut();
        ok(foxhunt_clean_push(
            locator.pointer(),
            &observation,
            generator,
            nowhere,
        ));
    }
    let mut answer = FoxhuntAnswer::without_fix(FoxhuntAnswerKind::Other, 0.0, 0.0);
    ok(foxhunt_clean_answer(locator.pointer(), &mut answer));
    assert_eq!(answer.kind, FoxhuntAnswerKind::Fix);
    assert_eq!(answer.fix.bearings, 3);
}

#[test]
fn a_line_comes_in_and_a_report_goes_out() {
    let mut vehicle = Storage::<FoxhuntVehicle>::new();
    let mut config = Storage::<FoxhuntVehicleConfig>::new();
    ok(foxhunt_vehicle_config_default(config.pointer()));
    // The list is the caller's, and kept.
    let frequencies = [144_500_000_u32, 433_920_000];
    let told = door::get(config.pointer()).map(|mut config| {
        config.lines.frequencies_hz = frequencies.as_ptr();
        config.lines.frequencies = frequencies.len();
        config
    });
    let told = told.unwrap();
    assert_eq!(text(foxhunt_vehicle_config_fault(&told)), "");
    ok(foxhunt_vehicle_init(
        vehicle.pointer(),
        Storage::<FoxhuntVehicle>::SIZE,
        &told,
    ));
    for byte in b"$PFOXQ*50\r\n" {
        let nowhere = std::ptr::null_mut();
        ok(foxhunt_vehicle_push(vehicle.pointer(), 1, *byte, nowhere));
    }
    let report = text(foxhunt_vehicle_report(vehicle.pointer()));
    assert!(report.starts_with("$PFOXN,"), "{report}");
}

#[test]
fn a_map_is_read_in_place() {
    const MAP: &[u8] = include_bytes!("../../tests/portable/data/tunnel.moments");
    let mut config = Storage::<FoxhuntTrackerConfig>::new();
    let mut site = Storage::<FoxhuntSite>::new();
    let mut tracker = Storage::<FoxhuntTracker>::new();
    let mut workspace = Storage::<FoxhuntWorkspace>::new();
    let mut generator = generator();
    ok(foxhunt_tracker_config_tunnel(config.pointer()));
    ok(foxhunt_site_init(
        site.pointer(),
        Storage::<FoxhuntSite>::SIZE,
        MAP.as_ptr(),
        MAP.len(),
        config.pointer(),
    ));
    let size = Storage::<FoxhuntTracker>::SIZE;
    ok(foxhunt_tracker_init(tracker.pointer(), size));
    let size = Storage::<FoxhuntWorkspace>::SIZE;
    ok(foxhunt_workspace_init(workspace.pointer(), size));
    let mut updates = 0;
    for packet in 0..4_u8 {
        let mut updated = 0;
        ok(foxhunt_tracker_push(
            tracker.pointer(),
            600 * u32::from(packet),
            packet % 2,
            -70.0,
            site.pointer(),
            workspace.pointer(),
            generator.pointer(),
            &mut updated,
            std::ptr::null_mut(),
        ));
        updates += updated;
    }
    assert!(updates > 0);
    let mut fix = Storage::<FoxhuntTagFix>::new();
    ok(foxhunt_tracker_fix(tracker.pointer(), fix.pointer()));
}
