"""Judges the references by a second way to the same images: radiance at vertices, interpolated, as the library does it.

    python verify.py [--only SCENE] [--rays 4096]     needs the variant llvm_ad_rgb

Only ray casting comes from Mitsuba here. Light, cosine, 1/pi, albedo, bounces, camera and interpolation are written again,
so a wrong convention on either side shows. The result is what a correct precomputed transfer can reach on these meshes:
Monte Carlo noise of the image plus interpolation between vertices. Prints one line per image:
relative MSE where the mask is on, its share of the image, and the relative MSE of wrong answers, which a test must reject.
"""

import argparse
import json

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import lights  # noqa: E402
import make  # noqa: E402
import meshes  # noqa: E402

# Origin of shadow rays above the surface, and of the samples per pixel and axis.
OFFSET = 1e-5
SAMPLES = 8
CHUNK = 1 << 22


def fibonacci(count):
    """Equal-weight directions over the whole sphere, turned by a fixed rotation."""
    i = np.arange(count) + 0.5
    z, phi = 1 - 2 * i / count, i * np.pi * (3 - 5**0.5)
    r = np.sqrt(1 - z * z)
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], 1) @ turn.T


class Baker:
    """Irradiance over pi at the vertices of one mesh, by a sum over directions [N, 3] with weights [N] in steradians."""

    def __init__(self, mesh, directions, weights):
        self.mesh, self.s, self.weights = mesh, directions, weights
        self.scene = mi.load_dict({"type": "scene", "shape": make.mitsuba_mesh(mesh)})
        f, p = mesh.faces, mesh.positions
        self.face_normals = np.cross(p[f[:, 1]] - p[f[:, 0]], p[f[:, 2]] - p[f[:, 0]])
        self.scale = np.ptp(p, axis=0).max()

    def blocks(self):
        step = max(1, CHUNK // len(self.s))
        for start in range(0, len(self.mesh.positions), step):
            yield np.arange(start, min(start + step, len(self.mesh.positions)))

    def trace(self, block):
        """Cosines [B, N], and of the nearest hits: a mask, triangle, barycentrics."""
        normals = self.mesh.normals[block]
        cosine = np.maximum(normals @ self.s.T, 0)
        origins = self.mesh.positions[block] + OFFSET * self.scale * normals
        o = np.repeat(origins, len(self.s), 0).astype(np.float32)
        d = np.tile(self.s, (len(block), 1)).astype(np.float32)
        rays = mi.Ray3f(mi.Point3f(o.T), mi.Vector3f(d.T))
        found = self.scene.ray_intersect_preliminary(rays, coherent=False, active=mi.Bool((cosine > 0).ravel()))
        hit = np.array(found.is_valid()).reshape(cosine.shape)
        return cosine, hit, np.array(found.prim_index).reshape(cosine.shape), np.array(found.prim_uv).T.reshape(*cosine.shape, 2)

    def direct(self, radiance, shadowed=True):
        """Light [V, 3] from outside, whose radiance in the directions is [N, 3]."""
        light = radiance * self.weights[:, None] / np.pi
        out = []
        for block in self.blocks():
            cosine, hit, _, _ = self.trace(block) if shadowed else (np.maximum(self.mesh.normals[block] @ self.s.T, 0), False, 0, 0)
            out.append(np.where(hit, 0, cosine) @ light)
        return np.concatenate(out)

    def reflected(self, previous):
        """One more bounce of light; surfaces reflect only from their front."""
        leaving = self.mesh.albedo * previous
        out = np.zeros_like(previous)
        for block in self.blocks():
            cosine, hit, triangle, uv = self.trace(block)
            row, column = np.nonzero(hit & (cosine > 0))
            t, (u, v) = triangle[row, column], uv[row, column].T
            front = np.einsum("ij,ij->i", self.face_normals[t], self.s[column]) < 0
            a, b, c = self.mesh.faces[t].T
            arriving = (1 - u - v)[:, None] * leaving[a] + u[:, None] * leaving[b] + v[:, None] * leaving[c]
            arriving *= (front * cosine[row, column] * self.weights[column] / np.pi)[:, None]
            for channel in range(3):
                out[block, channel] = np.bincount(row, arriving[:, channel], len(block))
        return out

    def image(self, view, colors):
        """Pixels [H, W, 3], depth along the view axis per sample [H, W, k] (infinite where nothing is hit)."""
        n = make.SIZE * SAMPLES
        x, y = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n)
        eye, target, up = (np.array(view[key]) for key in ("eye", "target", "up"))
        forward = meshes.normalized(target - eye)
        right = meshes.normalized(np.cross(forward, up))
        tan = np.tan(np.radians(view["fov_y_degrees"]) / 2)
        d = forward + tan * ((2 * x - 1)[..., None] * right + (1 - 2 * y)[..., None] * np.cross(right, forward))
        rays = mi.Ray3f(mi.Point3f(eye.astype(np.float32)), mi.Vector3f(d.reshape(-1, 3).T.astype(np.float32)))
        found = self.scene.ray_intersect_preliminary(rays, coherent=False)
        hit, (u, v) = np.array(found.is_valid()), np.array(found.prim_uv)
        corners = self.mesh.faces[np.where(hit, np.array(found.prim_index), 0)]
        w = np.stack([1 - u - v, u, v], 1) * hit[:, None]
        pixels = np.einsum("ijk,ij->ik", colors[corners], w)
        depth = np.where(hit, np.array(found.t), np.inf)  # d has length 1 along `forward`
        fold = lambda a: a.reshape(make.SIZE, SAMPLES, make.SIZE, SAMPLES, -1).swapaxes(1, 2).reshape(make.SIZE, make.SIZE, SAMPLES**2, -1)
        return fold(pixels).mean(2), fold(depth)[..., 0]


def mask(depth, tolerance=0.05):
    """True where every sample of the 3x3 neighbourhood hits and their depths span less than `tolerance` of the nearest."""
    near, far = depth.min(2), depth.max(2)
    pad = lambda a, value: np.pad(a, 1, constant_values=value)
    windows = lambda a: np.lib.stride_tricks.sliding_window_view(a, (3, 3))
    nearest = windows(pad(near, np.inf)).min((2, 3))
    farthest = windows(pad(far, 0)).max((2, 3))
    return farthest < (1 + tolerance) * nearest


def relmse(image, reference, on):
    return ((image - reference)[on] ** 2).sum() / (reference[on] ** 2).sum()


def relmse_pixel(image, reference, on):
    r = reference[on]
    return ((image[on] - r) ** 2 / (r**2 + 0.01 * r.mean() ** 2)).mean()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", help="scene or image")
    parser.add_argument("--rays", type=int, default=4096, help="rays per hemisphere; a map takes one per texel")
    options = parser.parse_args()
    records = json.loads((make.HERE / "scenes.json").read_text())["images"]
    print(f"{'image':32} {'relmse':>8} {'pixel':>8} {'noise':>8} {'mask':>5} | {'no shadow':>9} {'other b':>8} {'mirrored':>8}")
    for record in records:
        if options.only in (None, record["scene"], record["name"]):
            judge = judge_map if "environment" in record else judge_light
            print(judge(record, make.mesh_of(record["scene"]), options.rays), flush=True)


def judge_light(record, mesh, rays):
    """Against the right answer, then: no shadows, 0 for 2 bounces or the reverse, and the light's x turned round."""
    directions = fibonacci(2 * rays)
    baker = Baker(mesh, directions, np.full(2 * rays, 2 * np.pi / rays))
    light = make.light_named(record["light"])
    passes = [baker.direct(light.radiance(directions))]
    for _ in range(2):
        passes.append(baker.reflected(passes[-1]))
    answers = {0: passes[0], 2: sum(passes)}
    unshadowed = baker.direct(light.radiance(directions), shadowed=False)
    mirrored = baker.direct(light.radiance(directions * [-1, 1, 1]))
    return line(record, baker, answers[record["bounces"]], [unshadowed, answers[2 - record["bounces"]], mirrored])


def judge_map(record, mesh, _rays):
    """One direction per texel: edges of shadows of small lamps come out harder than in the image."""
    assert record["bounces"] == 0
    pixels = make.read_map(record["environment"].removeprefix("env/").removesuffix(".hdr")).astype(float)
    h, w, _ = pixels.shape
    theta, phi = np.pi * (np.arange(h) + 0.5) / h, 2 * np.pi * (np.arange(w) + 0.5) / w
    r, y = np.sin(theta)[:, None], np.cos(theta)[:, None]
    directions = np.stack([r * np.sin(phi), y + 0 * phi, -r * np.cos(phi)], 2).reshape(-1, 3)
    edges = np.cos(np.pi * np.arange(h + 1) / h)
    weights = np.repeat((edges[:-1] - edges[1:]) * 2 * np.pi / w, w)
    baker = Baker(mesh, directions, weights)
    turned = pixels[:, ::-1].reshape(-1, 3)
    pixels = pixels.reshape(-1, 3)
    right = baker.direct(pixels)
    return line(record, baker, right, [baker.direct(pixels, shadowed=False), right + baker.reflected(right), baker.direct(turned)])


def line(record, baker, right, wrong):
    reference = np.array(mi.Bitmap(str(make.HERE / record["image"])), dtype=np.float64)
    picture, depth = baker.image(record["camera"], baker.mesh.albedo * right)
    on = mask(depth)
    errors = [relmse(baker.image(record["camera"], baker.mesh.albedo * answer)[0], reference, on) for answer in wrong]
    numbers = f"{relmse(picture, reference, on):8.1e} {relmse_pixel(picture, reference, on):8.1e} {record['noise_relmse']:8.1e}"
    return f"{record['name']:32} {numbers} {on.mean():5.2f} |  " + " ".join(f"{error:8.1e}" for error in errors)


if __name__ == "__main__":
    main()
