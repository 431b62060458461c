//! Where a contact is and how hard it presses, from strain.
