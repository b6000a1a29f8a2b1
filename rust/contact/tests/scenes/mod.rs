//! Small meshes that the integration tests press: jittered flat skin, paraboloids, plates.
#![allow(dead_code, clippy::unwrap_used)]

use std::ops::Deref;

use thenar_contact::{
    ActiveEffect, Contact, ContactError, Control, Course, Material, Model, Press, Row, Run, Skin,
    SkinInput, Stand, Start, Step, Unsolved, Walk, Workspace,
};
use thenar_surface::{Mesh, Product, Vec3};

/// A reproducible sequence in [0, 1).
pub struct Dice(pub u64);

impl Dice {
    pub fn roll(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A skin with one workspace for all its presses: each finds what the one before has left.
#[derive(Clone)]
pub struct Bench {
    pub skin: Skin,
    pub workspace: Workspace,
}

impl From<Skin> for Bench {
    fn from(skin: Skin) -> Bench {
        let workspace = Workspace::default();
        Bench { skin, workspace }
    }
}

impl Deref for Bench {
    type Target = Skin;

    fn deref(&self) -> &Skin {
        &self.skin
    }
}

impl Bench {
    pub fn press(&mut self, press: &Press<'_>, control: &Control) -> Result<Contact, ContactError> {
        self.workspace.on(&self.skin).press(press, control)
    }

    pub fn run(&mut self, run: &Run<'_>, control: &Control) -> Result<Course, ContactError> {
        self.workspace.on(&self.skin).run(run, control)
    }

    pub fn advance(
        &mut self,
        walk: &mut Walk,
        row: (&Stand<'_>, &Row),
        control: &Control,
    ) -> Result<Step, ContactError> {
        self.workspace.on(&self.skin).advance(walk, row, control)
    }

    /// Goes on with the skin of these effects.
    pub fn set_effects(
        &mut self,
        effects: Vec<ActiveEffect>,
        control: &Control,
    ) -> Result<(), ContactError> {
        self.skin = self.skin.with_effects(effects, control)?;
        Ok(())
    }

    /// Goes on with the skin of these materials.
    pub fn set_materials(
        &mut self,
        materials: &[Material],
        control: &Control,
    ) -> Result<(), ContactError> {
        self.skin = self.skin.with_materials(materials, control)?;
        Ok(())
    }
}

/// A triangular lattice of `size` mm each way from the origin, jittered by 15 % of its spacing, normals up.
pub fn lattice(size: f64, spacing: f64, jitter: f64) -> Mesh {
    let rows = (size / (spacing * 0.75f64.sqrt())).ceil() as i64;
    let columns = (size / spacing).ceil() as i64;
    let mut dice = Dice(7);
    let mut positions = Vec::new();
    for row in -rows..=rows {
        for column in -columns..=columns {
            let shift = if row.rem_euclid(2) == 1 { 0.5 } else { 0.0 };
            let x = (column as f64 + shift + jitter * (dice.roll() - 0.5)) * spacing;
            let y = (row as f64 + jitter * (dice.roll() - 0.5)) * spacing * 0.75f64.sqrt();
            positions.push(Vec3::new(x, y, 0.0));
        }
    }
    let width = (2 * columns + 1) as u32;
    let mut triangles = Vec::new();
    for row in 0..2 * rows as u32 {
        for column in 0..width - 1 {
            let (a, b) = (row * width + column, row * width + column + 1);
            let (c, d) = (a + width, b + width);
            let is_odd = (i64::from(row) - rows).rem_euclid(2) == 1;
            triangles.extend(if is_odd {
                [[a, b, d], [a, d, c]]
            } else {
                [[a, b, c], [b, d, c]]
            });
        }
    }
    Mesh::new(positions, triangles).unwrap()
}

pub fn flat_skin(size: f64, spacing: f64, material: Material, model: Model) -> Bench {
    let mesh = lattice(size, spacing, 0.3);
    let input = SkinInput {
        mesh,
        regions: Vec::new(),
        materials: vec![material],
        model,
    };
    Bench::from(Skin::prepare(input, &Control::none()).unwrap())
}

/// A paraboloid z = r^2 / 2R - depth above the skin, capped, as a fine closed mesh of `extent` mm radius.
///
/// Keep `extent` beyond the skin's: the rim of a smaller one touches too.
pub fn paraboloid(radius: f64, depth: f64, extent: f64) -> Product {
    revolve(|r| r * r / (2.0 * radius) - depth, extent, 160)
}

/// A closed body under a lid: its lower surface is `profile(r)` revolved about z.
pub fn revolve(profile: impl Fn(f64) -> f64, extent: f64, rings: usize) -> Product {
    let sectors = 256u32;
    let mut positions = vec![Vec3::new(0.0, 0.0, profile(0.0))];
    for ring in 1..=rings {
        let r = extent * ring as f64 / rings as f64;
        for sector in 0..sectors {
            let angle = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            positions.push(Vec3::new(r * angle.cos(), r * angle.sin(), profile(r)));
        }
    }
    let lid = positions.len() as u32;
    positions.push(Vec3::new(0.0, 0.0, profile(extent) + 5.0));
    let at = |ring: u32, sector: u32| 1 + (ring - 1) * sectors + sector % sectors;
    let mut triangles = Vec::new();
    for s in 0..sectors {
        triangles.push([0, at(1, s + 1), at(1, s)]);
        for ring in 1..rings as u32 {
            let (a, b, c, d) = (
                at(ring, s),
                at(ring, s + 1),
                at(ring + 1, s),
                at(ring + 1, s + 1),
            );
            triangles.extend([[a, b, d], [a, d, c]]);
        }
        triangles.push([lid, at(rings as u32, s), at(rings as u32, s + 1)]);
    }
    Product::new(Mesh::new(positions, triangles).unwrap()).unwrap()
}

pub fn press(skin: &mut Bench, product: &Product) -> Contact {
    let press = Press {
        product,
        posed: None,
        force: None,
        drag: None,
        start: Start::Fresh,
        unsolved: Unsolved::Refuse,
    };
    skin.press(&press, &Control::none()).unwrap()
}

pub fn press_posed(skin: &mut Bench, product: &Product, posed: &[Vec3]) -> Contact {
    let press = Press {
        product,
        posed: Some(posed),
        force: None,
        drag: None,
        start: Start::Fresh,
        unsolved: Unsolved::Refuse,
    };
    skin.press(&press, &Control::none()).unwrap()
}

/// Shear modulus of `material`, MPa.
pub const SHEAR_MODULUS: f64 = 0.02;

/// One modulus at every depth.
pub fn material(thickness_mm: f64) -> Material {
    Material {
        g0_mpa: SHEAR_MODULUS,
        g_lim_mpa: SHEAR_MODULUS,
        thickness_mm,
        ..Material::finger()
    }
}

/// A skin of `material` with friction of coefficient `mu`.
pub fn rubbing_skin(mesh: &Mesh, thickness_mm: f64, mu: f64) -> Bench {
    let input = SkinInput {
        mesh: mesh.clone(),
        regions: Vec::new(),
        materials: vec![material(thickness_mm)],
        model: Model::Layer,
    };
    let mut skin = Bench::from(Skin::prepare(input, &Control::none()).unwrap());
    let friction = ActiveEffect::named("friction", 1.0).unwrap();
    let friction = friction.with("coefficient", mu).unwrap();
    skin.set_effects(vec![friction], &Control::none()).unwrap();
    skin
}
