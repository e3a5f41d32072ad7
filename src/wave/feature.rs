//! What a scene may have or lack, and what paths carry for it.

use super::plan::Plan;
use crate::material::Kind;

/// Something that only some scenes have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// Surfaces between mirror and Lambertian.
    Matt,
    /// Perfect mirrors.
    Specular,
    /// Glass.
    Transparent,
    /// The scale that paths carry: of radiance where glass refracts, of energy on light paths.
    Scale,
    /// Surfaces of several kinds, by which paths are sorted.
    Kinds,
    /// Interpolated normals.
    Smooth,
    /// Radiance from outside the scene.
    Background,
    /// Lights, and connections to them.
    Lights,
    /// So many lights that one is chosen by where it is needed.
    Choice,
    /// Light that mirrors and glass focus.
    Focus,
}

impl Feature {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Matt,
        Self::Specular,
        Self::Transparent,
        Self::Scale,
        Self::Kinds,
        Self::Smooth,
        Self::Background,
        Self::Lights,
        Self::Choice,
        Self::Focus,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Matt => "matt",
            Self::Specular => "specular",
            Self::Transparent => "transparent",
            Self::Scale => "scale",
            Self::Kinds => "kinds",
            Self::Smooth => "smooth",
            Self::Background => "background",
            Self::Lights => "lights",
            Self::Choice => "choice",
            Self::Focus => "focus",
        }
    }
    /// The feature of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|feature| feature.name() == name)
    }
}

impl Plan {
    /// Whether the scene has it, so that its stages, or its part of them, run.
    pub fn uses(&self, feature: Feature) -> bool {
        match feature {
            Feature::Matt => self.kinds.contains(&Kind::Matt),
            Feature::Specular => self.kinds.contains(&Kind::Specular),
            Feature::Transparent => self.kinds.contains(&Kind::Transparent),
            Feature::Scale => self.transmit || self.caustics(),
            Feature::Kinds => self.kinds.len() > 1,
            Feature::Smooth => self.smooth,
            Feature::Background => self.escape,
            Feature::Lights => self.emit,
            Feature::Choice => self.receivers,
            Feature::Focus => self.caustics(),
        }
    }
    /// Bytes of columns that each path has because of it, and would not have without.
    pub fn feature_bytes(&self, feature: Feature) -> usize {
        let names: &[&str] = match feature {
            Feature::Matt | Feature::Specular | Feature::Transparent | Feature::Smooth => &[],
            Feature::Scale => &["refraction."],
            Feature::Kinds => &["lists.surfaces"],
            Feature::Background => &["lists.escaped"],
            Feature::Lights => &["connection.", "lists.lights"],
            Feature::Choice => &["receiver."],
            Feature::Focus => &["first bounce.", "paths that look for focused light"],
        };
        let columns = self.columns();
        let own = columns.iter().filter(|(column, _)| names.iter().any(|name| column.starts_with(name)));
        own.map(|(_, bytes)| bytes).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::queues::tests::plan;
    use super::*;
    use crate::world::MaterialInput;

    /// All that is not of every path is of a feature; what a scene lacks takes nothing.
    #[test]
    fn columns_are_of_paths_or_of_a_feature() {
        let lamp = MaterialInput::Luminous { radiance: [1.0; 3] };
        let diffuse = MaterialInput::Diffuse { color: [0.5; 3], mattness: 1.0 };
        let matt = MaterialInput::Diffuse { color: [0.5; 3], mattness: 0.5 };
        let mirror = MaterialInput::Specular { color: [0.5; 3] };
        let glass = MaterialInput::Transparent { color: [1.0; 3], ref_index: 1.5 };
        let least = plan(std::slice::from_ref(&diffuse), 0.0);
        assert!(Feature::ALL.iter().all(|&f| !least.uses(f) && least.feature_bytes(f) == 0));
        let all = plan(&[diffuse, matt, mirror, glass, lamp], 1.0);
        let used: Vec<Feature> = Feature::ALL.into_iter().filter(|&f| all.uses(f)).collect();
        // The scene has one light and no normals.
        assert_eq!(used.len(), Feature::ALL.len() - 2, "{used:?}");
        let own: usize = Feature::ALL.iter().map(|&f| all.feature_bytes(f)).sum();
        assert_eq!(all.path_bytes() - own, least.path_bytes());
    }

    #[test]
    fn names_are_of_one_feature_each() {
        assert!(Feature::ALL.iter().all(|&f| Feature::from_name(f.name()) == Some(f)));
        assert_eq!(Feature::from_name("glass"), None);
    }
}
