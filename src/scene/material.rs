//! Reads the `materials` of a scene.

use super::fields::{self, Fields, Range};
use super::json::Node;
use super::problems::Problems;
use crate::world::MaterialInput;

const KEYS: &[&str] = &["type", "color", "mattness", "refIndex", "isLuminous", "radiance", "comment"];
const TYPES: &[&str] = &["diffuse", "specular", "transparent"];

/// Reads the material at `node`. A number that this kind of material has no use for must still be a number, but may be
/// any: scenes carry `mattness` and `refIndex` along for all their materials.
pub(super) fn read(node: &Node, path: &str, problems: &mut Problems) -> Option<MaterialInput> {
    let fields = Fields::open(node, path, KEYS, problems)?;
    fields.comment(problems);
    let kind = fields
        .require("type", "\"diffuse\", \"specular\" or \"transparent\"", problems)
        .and_then(|node| fields::choice(node, &fields.path("type"), TYPES, problems));
    let color = fields
        .require("color", "a colour as r, g and b, each in [0, 1]", problems)
        .and_then(|node| fields::color(node, &fields.path("color"), &Range::UNIT, problems));
    let luminous = match fields.get("isLuminous") {
        Some(node) => fields::boolean(node, &fields.path("isLuminous"), problems),
        None => Some(false),
    };
    let used = |yes: bool, range: Range| if yes { range } else { Range::ANY };
    let dark = luminous == Some(false);
    let mattness_range = used(dark && kind == Some("diffuse"), Range::UNIT);
    let mattness = fields.number("mattness", &mattness_range, 1.0, problems);
    let ref_index = if dark && kind == Some("transparent") {
        fields.required_number("refIndex", &Range::POSITIVE, problems)
    } else {
        fields.number("refIndex", &Range::ANY, 1.0, problems)
    };
    let radiance = fields.number("radiance", &used(luminous == Some(true), Range::NOT_NEGATIVE), 1.0, problems);

    let (kind, color, mattness, ref_index, radiance) = (kind?, color?, mattness?, ref_index?, radiance?);
    let single = color.map(|channel| channel as f32);
    Some(match (luminous?, kind) {
        (true, _) => MaterialInput::Luminous { radiance: color.map(|channel| (channel * radiance) as f32) },
        (false, "specular") => MaterialInput::Specular { color: single },
        (false, "transparent") => MaterialInput::Transparent { color: single, ref_index: ref_index as f32 },
        (false, _) => MaterialInput::Diffuse { color: single, mattness: mattness as f32 },
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::json;
    use super::*;

    fn material(keys: &str) -> Result<MaterialInput, Vec<String>> {
        let text = format!(r#"{{"color": {{"r": 1, "g": 0.5, "b": 0}}, {keys}}}"#);
        let mut problems = Problems::new(Path::new("s"), &text);
        let node = json::parse(&text, &mut problems).expect("valid JSON");
        let material = read(&node, "materials[0]", &mut problems);
        material.ok_or_else(|| problems.into_parts().0.iter().map(ToString::to_string).collect())
    }

    const COLOR: [f32; 3] = [1.0, 0.5, 0.0];

    #[test]
    fn kinds_and_defaults() {
        assert_eq!(material(r#""type": "diffuse""#), Ok(MaterialInput::Diffuse { color: COLOR, mattness: 1.0 }));
        assert_eq!(
            material(r#""type": "diffuse", "mattness": 0.25, "refIndex": 0, "isLuminous": "false""#),
            Ok(MaterialInput::Diffuse { color: COLOR, mattness: 0.25 })
        );
        assert_eq!(
            material(r#""type": "specular", "mattness": 7, "radiance": -1"#),
            Ok(MaterialInput::Specular { color: COLOR })
        );
        assert_eq!(
            material(r#""type": "transparent", "refIndex": 1.5"#),
            Ok(MaterialInput::Transparent { color: COLOR, ref_index: 1.5 })
        );
    }

    #[test]
    fn a_luminous_material_emits_colour_times_radiance_whatever_its_type() {
        for kind in TYPES {
            assert_eq!(
                material(&format!(r#""type": "{kind}", "isLuminous": "true", "radiance": 12"#)),
                Ok(MaterialInput::Luminous { radiance: [12.0, 6.0, 0.0] })
            );
        }
        assert_eq!(
            material(r#""type": "diffuse", "isLuminous": true"#),
            Ok(MaterialInput::Luminous { radiance: COLOR })
        );
    }

    #[test]
    fn what_is_used_is_checked() {
        for wrong in [
            r#""type": "diffuse", "mattness": 1.01"#,
            r#""type": "transparent""#,
            r#""type": "transparent", "refIndex": 0"#,
            r#""type": "diffuse", "isLuminous": true, "radiance": -1"#,
            r#""type": "specular", "mattness": "matt""#,
        ] {
            assert_eq!(material(wrong).map_err(|errors| errors.len()), Err(1), "{wrong}");
        }
    }
}
