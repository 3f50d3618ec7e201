//! Gives the linker the memory of the machine that `FOXHUNT_MACHINE` names.

use std::{env, fs, path::Path};

fn main() {
    println!("cargo::rerun-if-env-changed=FOXHUNT_MACHINE");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let machine = env::var("FOXHUNT_MACHINE").expect("FOXHUNT_MACHINE names a file of memory/");
    let memory = format!("memory/{machine}.x");
    println!("cargo::rerun-if-changed={memory}");
    let out = env::var("OUT_DIR").expect("cargo sets it");
    fs::copy(&memory, Path::new(&out).join("memory.x")).expect("the machine is known");
    println!("cargo::rustc-link-search={out}");
    if env::var("CARGO_CFG_TARGET_ARCH").as_deref() == Ok("riscv32") {
        println!("cargo::rustc-link-arg-bins=-Tmemory.x");
    }
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    if env::var_os("CARGO_FEATURE_VEHICLE").is_some() {
        println!("cargo::rustc-link-arg-bin=machines-vehicle=-Tdefmt.x");
    }
}
