//! From levels to edges.
