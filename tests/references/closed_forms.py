"""Numbers with a closed form for tests of transfer, written to closed_forms.json: `python closed_forms.py` (numpy only).

Transfer never includes the receiver's own albedo. `zonal` lists are coefficients [n] about an axis in the convention of the
library: f_lm = sqrt(4 pi / (2l+1)) zonal[l] y_lm(axis).

1. Disk over a plane. A disk of radius r parallel to a plane at height h blocks, seen from the point of the plane at
   distance a from its axis, this share of the cosine-weighted hemisphere (view factor from a differential element to a disk):
       F = 1/2 (1 - (a^2 + h^2 - r^2) / sqrt((a^2 + h^2 + r^2)^2 - 4 a^2 r^2));     a = 0: F = r^2 / (r^2 + h^2).
   On the axis the disk hides the cone z > c = h / sqrt(r^2 + h^2), so the transfer vector is zonal about the normal:
       zonal[l] = (1/pi) 2 pi sqrt((2l+1)/(4 pi)) integral_0^c z P_l(z) dz.

2. Two parallel coaxial disks of radius R at distance h that face each other, outer sides black, under constant radiance 1.
   With a = r^2 + s^2 + h^2, light from a ring of radius s arrives at radius r of the other disk with the kernel
       K(r, s) = integral dphi h^2 / (pi (a - 2 r s cos phi)^2) = 2 h^2 a / (a^2 - 4 r^2 s^2)^(3/2),
   E0(r) = 1 - F(r) on both, and pass b + 1 on disk A is albedo_B integral K(r, s) E_b^B(s) s ds. E is transfer . light.

3. Bowl: a sphere of radius R without the cap around +axis of half angle alpha (seen from the centre), albedo rho, inside.
   Between any two elements of a sphere the form factor is dA / (4 pi R^2), wherever they are. So a reflected pass is the same
   at every point, and with f = (1 + cos alpha) / 2, the share of the sphere that is there:
       mean of pass 0 over the whole sphere's area = (opening's area / (4 pi R^2)) (1/pi) H = (sin^2 alpha / (4 pi)) H,
   where H is the clamped cosine about +axis, for all light that enters the opening meets the bowl. Hence, as transfer vectors,
       pass b >= 1 = rho (rho f)^(b-1) (sin^2 alpha / (4 pi)) H(axis),    and under constant radiance 1
       pass 0 = 1 - f everywhere on the bowl (the opening's share of the sphere), pass b = (rho f)^b (1 - f).
   On a mesh that is inscribed in the sphere this holds to the order of the square of the edge length.
"""

import json
import math
from pathlib import Path

import numpy as np
from numpy.polynomial import Legendre, legendre


def disk_share(r, h, a):
    b = a * a + h * h
    return 0.5 * (1 - (b - r * r) / math.sqrt((b + r * r) ** 2 - 4 * a * a * r * r))


def cut_cosine_zonal(order, top):
    """Zonal coefficients of z on 0 < z < top, zero elsewhere."""
    out = []
    for l in range(order):
        primitive = Legendre(legendre.legmulx([0] * l + [1])).integ()
        out.append(2 * math.pi * math.sqrt((2 * l + 1) / (4 * math.pi)) * (primitive(top) - primitive(0)))
    return np.array(out)


def disk_over_plane(order=6):
    cases = []
    for r, h, a in [(1, 1, 0), (1, 0.5, 0), (0.5, 1, 0.7), (1, 0.25, 1), (1, 0.25, 2), (2, 1, 0.5)]:
        case = {"radius": r, "height": h, "offset": a, "blocked": disk_share(r, h, a)}
        if a == 0:
            case["transfer_zonal"] = (cut_cosine_zonal(order, h / math.hypot(r, h)) / math.pi).tolist()
        cases.append(case)
    return cases


def facing_disks(radius, height, albedo_a, albedo_b, passes=3):
    """Transfer . light of passes 0, 1, 2 at the centre and at half the radius of disk A."""
    x, w = legendre.leggauss(200)
    s, w = radius * (x + 1) / 2, radius * w / 2
    at = np.array([0, radius / 2])

    def gather(r, values):
        a = r[:, None] ** 2 + s**2 + height**2
        kernel = 2 * height**2 * a / (a * a - 4 * r[:, None] ** 2 * s**2) ** 1.5
        return kernel @ (values * s * w)

    direct = lambda r: np.array([1 - disk_share(radius, height, float(v)) for v in r])
    on_a, on_b, result = direct(s), direct(s), [direct(at)]
    for _ in range(passes - 1):
        result.append(albedo_b * gather(at, on_b))
        on_a, on_b = albedo_b * gather(s, on_b), albedo_a * gather(s, on_a)
    passes = np.array(result).T
    return {"radius": radius, "height": height, "albedo_a": albedo_a, "albedo_b": albedo_b,
            "center": passes[0].tolist(), "half_radius": passes[1].tolist()}


def bowl(half_angle_degrees, albedo, order=6, passes=4):
    alpha = math.radians(half_angle_degrees)
    f = (1 + math.cos(alpha)) / 2
    first = albedo * math.sin(alpha) ** 2 / (4 * math.pi) * cut_cosine_zonal(order, 1.0)
    return {"opening_half_angle_degrees": half_angle_degrees, "albedo": albedo, "share_of_sphere": f,
            "constant_light_passes": [(albedo * f) ** b * (1 - f) for b in range(passes)],
            "pass_1_zonal": first.tolist(), "pass_2_zonal": (albedo * f * first).tolist()}


def main():
    value = {
        "disk_over_plane": disk_over_plane(),
        "facing_disks": [facing_disks(1, 0.5, 0.5, 0.8), facing_disks(1, 1, 0.8, 0.8), facing_disks(2, 1, 0.3, 0.9)],
        "bowl": [bowl(60, 0.5), bowl(90, 0.8)],
    }
    path = Path(__file__).resolve().parent / "closed_forms.json"
    path.write_text(json.dumps(value, indent=1) + "\n")


if __name__ == "__main__":
    main()
