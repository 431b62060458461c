//! `--wiring`: channels that are sent in another order, or reversed.

use clap::Args;

use tactpad::pad::wiring::permutation::SignedPermutation;

/// How the pad is wired; flattened into the arguments of each verb that opens one.
#[derive(Debug, Args)]
pub(super) struct WiringOption {
    /// What channels are sent as, where bridges are exchanged or reversed: m0x=m1y,m1y=-m0x; `tactpad bench` finds it.
    #[arg(long, value_name = "WIRING")]
    pub(super) wiring: Option<SignedPermutation>,
}
