//! The wire protocol between a pad and its host.
#![no_std]
