//! A scene and its JSON text, laid out to be read: one material or object in one or two lines.

use crate::text::number;
use glam::{DVec3, dvec3};

/// A colour: linear red, green, blue.
pub type Color = [f64; 3];

/// How a surface treats light.
pub enum Kind {
    /// The mattness lobe: 1 is Lambertian, 0 a mirror.
    Diffuse(f64),
    /// A mirror.
    Specular,
    /// A smooth dielectric with this index of refraction.
    Transparent(f64),
    /// A light of this radiance.
    Luminous(f64),
}

/// Size of an object.
pub enum Size {
    /// Extent along z.
    Height(f64),
    /// Factor on the mesh's own size.
    Scale(f64),
}

/// A scene in the making.
pub struct Scene {
    camera: String,
    materials: Vec<String>,
    objects: Vec<String>,
}

impl Scene {
    /// A scene seen from `focal_point` towards `target`, `x_angle` degrees wide, pixels square.
    pub fn new(focal_point: DVec3, target: DVec3, [width, height]: [u32; 2], x_angle: f64) -> Self {
        let direction = target - focal_point;
        let y_half = (f64::from(height) / f64::from(width) * (0.5 * x_angle).to_radians().tan()).atan();
        let camera = format!(
            "    \"focalPoint\": {},\n    \"direction\": {},\n    \"xReso\": {width}, \"yReso\": {height},\n    \
             \"xAngle\": {}, \"yAngle\": {}\n",
            vector(focal_point),
            vector(direction),
            number(x_angle),
            number(2.0 * y_half.to_degrees()),
        );
        Self { camera, materials: Vec::new(), objects: Vec::new() }
    }

    /// Adds a material and gives its index.
    pub fn material(&mut self, comment: &str, kind: Kind, [r, g, b]: Color) -> usize {
        let (name, value) = match kind {
            Kind::Diffuse(mattness) => ("diffuse", format!(", \"mattness\": {}", number(mattness))),
            Kind::Specular => ("specular", String::new()),
            Kind::Transparent(index) => ("transparent", format!(", \"refIndex\": {}", number(index))),
            Kind::Luminous(_) => ("diffuse", String::new()),
        };
        let light = match kind {
            Kind::Luminous(radiance) => format!("true, \"radiance\": {}", number(radiance)),
            _ => "false".to_owned(),
        };
        let color = format!("{{\"r\": {}, \"g\": {}, \"b\": {}}}", number(r), number(g), number(b));
        self.materials.push(format!(
            "    {{\"comment\": \"{comment}\", \"type\": \"{name}\"{value}, \"color\": {color}, \"isLuminous\": {light}}}"
        ));
        self.materials.len() - 1
    }

    /// Adds the mesh `meshes/{mesh}.obj`, rotated about x, y, z by degrees, with its centre at `mid_point`.
    pub fn object(
        &mut self,
        comment: &str,
        mesh: &str,
        material: usize,
        mid_point: DVec3,
        size: Size,
        rotation: [f64; 3],
    ) {
        let size = match size {
            Size::Height(height) => format!("\"height\": {}", number(height)),
            Size::Scale(scale) => format!("\"scale\": {}", number(scale)),
        };
        let mut turn = String::new();
        for (axis, degrees) in ["xrot", "yrot", "zrot"].iter().zip(rotation).filter(|(_, degrees)| *degrees != 0.0) {
            turn += &format!(", \"{axis}\": {}", number(degrees));
        }
        self.objects.push(format!(
            "    {{\"comment\": \"{comment}\", \"type\": \"mesh\", \"path\": \"../meshes/{mesh}.obj\", \
             \"materialIndex\": {material},\n     \"midPoint\": {}, {size}{turn}}}",
            vector(mid_point)
        ));
    }

    /// Adds an object that stands on z = 0 at (x, y), turned about the vertical.
    pub fn standing(&mut self, comment: &str, mesh: &str, material: usize, [x, y]: [f64; 2], height: f64, zrot: f64) {
        let middle = dvec3(x, y, 0.5 * height);
        self.object(comment, mesh, material, middle, Size::Height(height), [0.0, 0.0, zrot]);
    }

    /// The scene file.
    pub fn to_json(&self) -> String {
        format!(
            "{{\n  \"camera\": {{\n{}  }},\n  \"materials\": [\n{}\n  ],\n  \"objects\": [\n{}\n  ]\n}}\n",
            self.camera,
            self.materials.join(",\n"),
            self.objects.join(",\n")
        )
    }
}

fn vector(v: DVec3) -> String {
    format!("{{\"x\": {}, \"y\": {}, \"z\": {}}}", number(v.x), number(v.y), number(v.z))
}
