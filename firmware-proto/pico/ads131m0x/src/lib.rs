//! The converters ADS131M02 to ADS131M08: simultaneous 24-bit delta-sigma channels on one SPI.
//!
//! Facts are those of the manufacturer's data sheets (Texas Instruments, SBAS853 and its sisters for other numbers of channels). Words
//! are 24 bits, the state after power-on. A frame is a command and its answer, the channels, and a checksum. The bus is SPI mode 1,
//! the most significant bit first.

#![no_std]

pub mod command;
pub mod config;
pub mod device;
pub mod frame;
