//! The drawing once more, as clouds of coloured points. Rerun reads point clouds from a log, but no scenes.

use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{
    Color, PackedElementField, Point3, PointCloud, Pose, SceneEntity, TriangleListPrimitive,
    Vector3,
};

use crate::report::log::messages::{Place, pose};

/// Distance between two points of a line, as a share of the area's size.
const SPACING: f64 = 0.004;

/// Points across a mark.
const ACROSS: i32 = 9;

/// Fields of a point: three single-precision coordinates, then four bytes of colour.
const FIELDS: [(&str, u32, NumericType); 7] = [
    ("x", 0, NumericType::Float32),
    ("y", 4, NumericType::Float32),
    ("z", 8, NumericType::Float32),
    ("red", 12, NumericType::Uint8),
    ("green", 13, NumericType::Uint8),
    ("blue", 14, NumericType::Uint8),
    ("alpha", 15, NumericType::Uint8),
];
const STRIDE: u32 = 16;

/// The cloud of all that an entity draws; `size` is the area's, in metres.
pub(super) fn of(entity: &SceneEntity, size: f64) -> PointCloud {
    let mut cloud = Cloud { spacing: SPACING * size, data: Vec::new() };
    for line in &entity.lines {
        let places: Vec<_> = line.points.iter().map(place).collect();
        cloud.strip(&places, line.r#type == 1, line.color);
    }
    for triangles in &entity.triangles {
        // A surface may be translucent. Its outline is not.
        let color = triangles.color.map(|color| Color { a: 1.0, ..color });
        cloud.strip(&outline(triangles), true, color);
    }
    for it in &entity.cubes {
        cloud.mark((it.pose, it.size, it.color), &[[1.0, 0.0]]);
    }
    for it in &entity.spheres {
        cloud.mark((it.pose, it.size, it.color), &[[1.0, 0.0], [0.0, 1.0]]);
    }
    PointCloud {
        timestamp: entity.timestamp,
        frame_id: entity.frame_id.clone(),
        pose: Some(pose([0.0, 0.0], 0.0)),
        point_stride: STRIDE,
        fields: FIELDS
            .map(|(name, offset, kind)| PackedElementField {
                name: name.to_owned(),
                offset,
                r#type: kind.into(),
            })
            .into(),
        data: cloud.data.into(),
    }
}

/// The corners of a polygon that is drawn as a fan of triangles about its first corner.
fn outline(triangles: &TriangleListPrimitive) -> Vec<Place> {
    let corners = triangles.points.chunks_exact(3).enumerate();
    let corners = corners.flat_map(|(k, corner)| if k == 0 { corner } else { &corner[2..] });
    corners.map(place).collect()
}

fn place(point: &Point3) -> Place {
    [point.x, point.y]
}

struct Cloud {
    /// Metres.
    spacing: f64,
    data: Vec<u8>,
}

impl Cloud {
    fn point(&mut self, at: Place, color: Option<Color>) {
        for coordinate in [at[0], at[1], 0.0] {
            self.data.extend((coordinate as f32).to_le_bytes());
        }
        let Color { r, g, b, a } = color.unwrap_or_default();
        self.data.extend([r, g, b, a].map(|part| (255.0 * part).round() as u8));
    }

    /// Points along a line, its corners included.
    fn strip(&mut self, places: &[Place], is_loop: bool, color: Option<Color>) {
        let back = places.first().filter(|_| is_loop);
        let ends = places.iter().skip(1).chain(back);
        for (from, to) in places.iter().zip(ends) {
            let length = libm::hypot(to[0] - from[0], to[1] - from[1]);
            let count = (length / self.spacing).ceil().max(1.0) as u32;
            for k in 0..count {
                let share = f64::from(k) / f64::from(count);
                self.point([0, 1].map(|i| from[i] + share * (to[i] - from[i])), color);
            }
        }
        if let Some(last) = places.last().filter(|_| !is_loop) {
            self.point(*last, color);
        }
    }

    /// A bar or a cross about a sample, whose arms run both ways along some axes.
    fn mark(
        &mut self,
        (pose, size, color): (Option<Pose>, Option<Vector3>, Option<Color>),
        axes: &[Place],
    ) {
        let at = pose.and_then(|pose| pose.position).map_or([0.0, 0.0], |at| [at.x, at.y]);
        let size = size.map_or(0.0, |size| size.x);
        self.point(at, color);
        let arm = ACROSS / 2;
        for [x, z] in axes {
            for k in (-arm..=arm).filter(|k| *k != 0) {
                let off = size * f64::from(k) / f64::from(2 * arm);
                self.point([at[0] + off * x, at[1] + off * z], color);
            }
        }
    }
}
