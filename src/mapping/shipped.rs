//! The profiles that are inside the program, so that it runs from any folder.

const SHIPPED: [(&str, &str); 4] = [
    ("super-mario", include_str!("../../mappings/super-mario.toml")),
    ("tetris", include_str!("../../mappings/tetris.toml")),
    ("tank-battle", include_str!("../../mappings/tank-battle.toml")),
    ("contra", include_str!("../../mappings/contra.toml")),
];

/// The names under which profiles are shipped.
pub fn names() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().map(|(name, _)| *name)
}

/// The TOML text of the shipped profile `name`, or `None` if there is none of that name.
pub fn text(name: &str) -> Option<&'static str> {
    SHIPPED.iter().find(|(shipped, _)| *shipped == name).map(|(_, text)| *text)
}
