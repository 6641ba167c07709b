#![no_std]
#![deny(unsafe_code)]
//! What the programs for an STM32F405 share.
//!
//! | module | does |
//! | --- | --- |
//! | `clock` | the core clock: crystal, internal oscillator, or none to set under emulation |
//! | `log` | defmt frames to RTT and to USART2, never waiting for a reader |
//! | `reset` | why the chip started |
//! | `stop` | the drive's enable pin; panics and faults pull it low, log, and restart |
//! | `watchdog` | restarts the chip when it hangs |

#[cfg(target_os = "none")]
pub mod clock;
#[cfg(target_os = "none")]
pub mod log;
#[cfg(target_os = "none")]
pub mod reset;
#[cfg(target_os = "none")]
pub mod stop;
#[cfg(target_os = "none")]
pub mod watchdog;
