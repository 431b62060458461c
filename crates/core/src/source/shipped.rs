//! The descriptions that are inside the program, so that it runs from any folder.

const SHIPPED: [(&str, &str); 7] = [
    ("load-cells", include_str!("../../../../models/sources/load-cells.toml")),
    ("balance-board", include_str!("../../../../models/sources/balance-board.toml")),
    ("balance-board-standing", include_str!("../../../../models/sources/balance-board-standing.toml")),
    ("tablet", include_str!("../../../../models/sources/tablet.toml")),
    ("touchpad", include_str!("../../../../models/sources/touchpad.toml")),
    ("magic-trackpad", include_str!("../../../../models/sources/magic-trackpad.toml")),
    ("spacemouse", include_str!("../../../../models/sources/spacemouse.toml")),
];

/// The names under which descriptions are shipped.
pub fn names() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().map(|(name, _)| *name)
}

/// The TOML text of the shipped description `name`, or `None` if there is none of that name.
pub fn text(name: &str) -> Option<&'static str> {
    SHIPPED.iter().find(|(shipped, _)| *shipped == name).map(|(_, text)| *text)
}

/// The descriptions' language as a JSON Schema, which editors read.
pub const fn schema() -> &'static str {
    include_str!("../../../../models/sources/source.schema.json")
}

/// The first line of a description beside which the schema lies: editors look for it.
pub const SCHEMA_LINE: &str = "#:schema ./source.schema.json\n";
