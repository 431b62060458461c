//! The influence field of the nominal pad: nine channels per newton at any contact point.
