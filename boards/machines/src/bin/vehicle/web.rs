//! For a program that runs WebAssembly.

use std::cell::RefCell;

use foxhunt_gateways::plain::{CONFIG, Gateway};

thread_local! {
    static GATEWAY: RefCell<Gateway> = const { RefCell::new(Gateway::EMPTY) };
}

/// Takes the next byte, and says how many bytes of a report there are for the message that ends with it.
#[unsafe(no_mangle)]
pub extern "C" fn push(byte: u8) -> usize {
    GATEWAY.with_borrow_mut(|gateway| match gateway.push(0, byte, &CONFIG) {
        Some(_) => gateway.report().len(),
        None => 0,
    })
}

/// Where the report is.
#[unsafe(no_mangle)]
pub extern "C" fn report() -> *const u8 {
    GATEWAY.with_borrow(|gateway| gateway.report().as_ptr())
}
