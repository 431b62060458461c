//! The host of the tray: the interface of the program around it.

/// The program around the tray. It is called on the tray's thread, so the bridge does not wait for it.
pub trait TrayHost {
    /// The names of the profiles that there are now, in the order of the menu.
    fn profiles(&mut self) -> Vec<String>;

    /// Which of them the bridge plays if it calls the profile `title`; `None` where it is none of them.
    fn playing(&mut self, title: &str) -> Option<String>;

    /// Keeps for the next start what is played. It is called some once a second.
    fn remember(&mut self);

    /// The address of the page that shows this bridge, if there is one.
    fn page(&self) -> Option<String>;
}
