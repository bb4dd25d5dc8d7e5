//! What accuracy costs in time.
#![cfg_attr(not(test), expect(dead_code, reason = "nothing measures yet"))]

mod front;
mod record;
mod report;
