//! The materials of the scene.

use crate::color::hex;
use crate::material::Material;
use crate::mesh::MaterialId;
use crate::scene::{Scene, Shades};

/// Every material, single or in shades.
pub struct Paints {
    pub water: Shades,
    pub foam: MaterialId,
    pub sand: Shades,
    pub grass: Shades,
    pub rock: Shades,
    pub paving: Shades,
    pub white: MaterialId,
    pub red: MaterialId,
    pub dark: MaterialId,
    pub lamp: MaterialId,
    pub glass: MaterialId,
    pub wood: Shades,
    /// Plaster of the houses' walls.
    pub coats: [MaterialId; 4],
    /// Tiles of the houses' roofs.
    pub tiles: [Shades; 2],
    pub pine: Shades,
    /// Crowns of broad-leaved trees, each kind in shades.
    pub leaves: [Shades; 4],
    pub flowers: Shades,
    pub sail: MaterialId,
    pub wool: MaterialId,
    pub beak: MaterialId,
}

impl Paints {
    /// Adds the materials to the scene.
    pub fn new(scene: &mut Scene) -> Self {
        let matte = |name: &str| Material::matte(name, hex(0xffffff));
        let water = matte("water").glossy(hex(0xa0b0b8), 70.0);
        let enamel = |name: &str, color| Material::matte(name, hex(color)).glossy(hex(0x606060), 40.0);
        let plain = |name: &str, color| Material::matte(name, hex(color));
        Self {
            water: scene.shades(
                &water,
                20,
                &[(0.0, 0x7fe0d0), (0.2, 0x3fc0c4), (0.45, 0x1f8fb8), (0.75, 0x14609c), (1.0, 0x0e3f78)],
            ),
            foam: scene.material(plain("foam", 0xf6fcff)),
            sand: scene.shades(&matte("sand"), 5, &[(0.0, 0xc9a66b), (0.4, 0xe9cf96), (1.0, 0xf6e5b8)]),
            grass: scene.shades(
                &matte("grass"),
                8,
                &[(0.0, 0x4f8a2c), (0.4, 0x72ad3a), (0.7, 0x96c24c), (1.0, 0xbcd065)],
            ),
            rock: scene.shades(&matte("rock"), 6, &[(0.0, 0x55504f), (0.5, 0x857a72), (1.0, 0xb3a697)]),
            paving: scene.shades(&matte("paving"), 3, &[(0.0, 0xc4b8a2), (1.0, 0xe6dcc6)]),
            white: scene.material(enamel("white", 0xf7f4ec)),
            red: scene.material(enamel("red", 0xd42a2a)),
            dark: scene.material(enamel("dark", 0x2c323c)),
            lamp: scene.material(enamel("lamp", 0xffdf70).glowing(hex(0xa07820))),
            glass: scene.material(plain("glass", 0x5f92b8).glossy(hex(0xe0e8f0), 100.0)),
            wood: scene.shades(&matte("wood"), 4, &[(0.0, 0x6a4628), (1.0, 0xa5733f)]),
            coats: [
                ("coat_cream", 0xf8ecd0),
                ("coat_blue", 0x8fc1dc),
                ("coat_rose", 0xf0a898),
                ("coat_ochre", 0xf2c14e),
            ]
            .map(|(name, color)| scene.material(plain(name, color))),
            tiles: [
                scene.shades(&matte("tile_red"), 5, &[(0.0, 0xa63a22), (0.5, 0xcc5530), (1.0, 0xe0764a)]),
                scene.shades(&matte("tile_slate"), 5, &[(0.0, 0x3d4a63), (0.5, 0x566684), (1.0, 0x7488a6)]),
            ],
            pine: scene.shades(&matte("pine"), 5, &[(0.0, 0x1f4a32), (0.5, 0x2f6d42), (1.0, 0x5b9a58)]),
            leaves: [
                scene.shades(&matte("leaf_green"), 4, &[(0.0, 0x3f7d2a), (1.0, 0x8fc24a)]),
                scene.shades(&matte("leaf_gold"), 4, &[(0.0, 0xc9821c), (1.0, 0xf7cf52)]),
                scene.shades(&matte("leaf_red"), 4, &[(0.0, 0xa8321e), (1.0, 0xee7a3c)]),
                scene.shades(&matte("blossom"), 4, &[(0.0, 0xd9789c), (1.0, 0xfbd3de)]),
            ],
            flowers: scene.shades(
                &matte("flower"),
                6,
                &[
                    (0.0, 0xe8304a),
                    (0.2, 0xff8a2a),
                    (0.4, 0xffe04a),
                    (0.6, 0xffffff),
                    (0.8, 0x9a6be0),
                    (1.0, 0x4a6ef0),
                ],
            ),
            sail: scene.material(plain("sail", 0xfdf6e4)),
            wool: scene.material(plain("wool", 0xf4efe4)),
            beak: scene.material(plain("beak", 0xf2a03a)),
        }
    }
}
