//! Numbers that have a closed form, made by `references/closed_forms.py`, where they are derived.

use serde::Deserialize;

/// All cases of `references/closed_forms.json`.
#[derive(Debug, Clone, Deserialize)]
pub struct ClosedForms {
    /// A disk parallel to a plane.
    pub disk_over_plane: Vec<DiskCase>,
    /// Two parallel disks that light each other.
    pub facing_disks: Vec<FacingDisksCase>,
    /// The inside of a part of a sphere.
    pub bowl: Vec<BowlCase>,
}

/// A disk over a plane.
#[derive(Debug, Clone, Deserialize)]
pub struct DiskCase {
    /// Radius of the disk.
    pub radius: f64,
    /// Its height over the plane.
    pub height: f64,
    /// Distance of the point on the plane from the axis of the disk.
    pub offset: f64,
    /// Share of the cosine-weighted hemisphere that the disk hides.
    pub blocked: f64,
    /// On the axis, the zonal coefficients of the transfer about the normal.
    pub transfer_zonal: Option<Vec<f64>>,
}

/// Two coaxial disks that face each other.
#[derive(Debug, Clone, Deserialize)]
pub struct FacingDisksCase {
    /// Radius of both.
    pub radius: f64,
    /// Distance between them.
    pub height: f64,
    /// Albedo of the first disk.
    pub albedo_a: f32,
    /// Albedo of the second.
    pub albedo_b: f32,
    /// Under constant light 1, what arrives at the centre of the first disk directly, after one and after two reflections, over π.
    pub center: Vec<f64>,
    /// The same at half its radius.
    pub half_radius: Vec<f64>,
}

/// The inside of a sphere without a cap.
#[derive(Debug, Clone, Deserialize)]
pub struct BowlCase {
    /// Angle between the axis of the opening and its rim, seen from the centre.
    pub opening_half_angle_degrees: f64,
    /// Albedo.
    pub albedo: f32,
    /// Under constant light 1, what each pass brings to every point, over π.
    pub constant_light_passes: Vec<f64>,
    /// Zonal coefficients about the axis of the opening of what the first reflection brings.
    pub pass_1_zonal: Vec<f64>,
    /// ... and the second.
    pub pass_2_zonal: Vec<f64>,
}

impl ClosedForms {
    /// The committed cases.
    ///
    /// # Errors
    /// If the file does not hold them.
    pub fn load() -> Result<Self, serde_json::Error> {
        serde_json::from_str(include_str!("../references/closed_forms.json"))
    }
}
