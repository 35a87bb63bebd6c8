"""Makes the references of this folder with Mitsuba 3: meshes, lights, images and the two JSON files. See README.md.

    pip install mitsuba numpy
    python make.py                       # all of it, variant scalar_rgb: about two hours on 2 cores
    python make.py --only pillar         # the images of one scene; the rest of scenes.json is kept
    python make.py --variant llvm_ad_rgb # the same estimator, ten times faster, needs LLVM (DRJIT_LIBLLVM_PATH)
    python make.py --meshes              # meshes and lights.json only, no rendering

Seeds are fixed: one variant and one --spp give the same images again. Another variant or spp gives others within the noise
that scenes.json records.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

import lights
import meshes

HERE = Path(__file__).resolve().parent
DATA = Path(os.environ.get("PRT_DATA", HERE.parents[2] / "shared" / "data"))

# A camera is a pinhole: image right = normalize(forward x up), pixel (0, 0) at the top left, square pixels.
VIEWS = {
    "sphere_on_plane": {"eye": [2.6, 3.1, 4.6], "target": [0.0, 0.75, 0.0], "up": [0.0, 1.0, 0.0], "fov_y_degrees": 36.0},
    "pillar": {"eye": [2.2, 3.1, 3.6], "target": [0.1, 0.35, 0.05], "up": [0.0, 1.0, 0.0], "fov_y_degrees": 36.0},
    "bowl": {"eye": [0.9, 2.9, 2.3], "target": [0.0, -0.25, 0.0], "up": [0.0, 1.0, 0.0], "fov_y_degrees": 36.0},
    "spot": {"eye": [-2.5, 1.0, -1.9], "target": [0.0, 0.1, 0.12], "up": [0.0, 1.0, 0.0], "fov_y_degrees": 31.0},
}
SIZE = 96
# Samples per pixel of one pass: 32 x 32 for the multi-jittered sampler; two halves make the smallest --spp.
PASS = 1024
SPOT = {"file": "meshes/spot.obj", "subdivisions": 1, "albedo": [0.8, 0.8, 0.8]}
MAPS = ["grace_256", "uffizi_256"]
BAND_LIMITED = [(light, bounces) for light in ("soft4", "soft6") for bounces in (0, 2)]


def images():
    """Every image: (name, scene, light or map, bounces)."""
    for scene in VIEWS:
        for light, bounces in BAND_LIMITED:
            yield f"{scene}_{light}_b{bounces}", scene, light, bounces
    for light in MAPS:
        yield f"sphere_on_plane_{light}_b0", "sphere_on_plane", light, 0


def main():
    options = parse()
    write_lights_and_meshes()
    if options.meshes:
        return
    mi.set_variant(options.variant)
    mi.set_log_level(mi.LogLevel.Warn)
    check_conventions()
    records = kept_records(options)
    for name, scene, light, bounces in images():
        if options.only in (None, scene, name):
            records[name] = make_image(name, scene, light, bounces, options)
            write_json(HERE / "scenes.json", {"mitsuba": mi.__version__, "images": in_order(records)})


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", metavar="SCENE", help="a scene (%s) or the name of one image" % ", ".join(VIEWS))
    parser.add_argument("--spp", type=int, default=16384, help="samples per pixel, a multiple of 2048")
    parser.add_argument("--variant", default="scalar_rgb", help="Mitsuba variant")
    parser.add_argument("--meshes", action="store_true", help="write meshes and lights only")
    options = parser.parse_args()
    if options.spp <= 0 or options.spp % (2 * PASS):
        parser.error(f"--spp must be a positive multiple of {2 * PASS}")
    if options.only and not any(options.only in (scene, name) for name, scene, _, _ in images()):
        parser.error(f"--only {options.only}: no such scene or image")
    return options


def write_lights_and_meshes():
    (HERE / "scenes").mkdir(exist_ok=True)
    (HERE / "images").mkdir(exist_ok=True)
    write_json(HERE / "lights.json", {"lights": [light.record() for light in lights.all_lights()]})
    for name, build in meshes.SCENES.items():
        meshes.write_ply(build(), HERE / "scenes" / f"{name}.ply")


def write_json(path, value):
    path.write_text(json.dumps(value, indent=1) + "\n")


def kept_records(options):
    """Records of images that this run does not make again."""
    path = HERE / "scenes.json"
    if options.only is None or not path.exists():
        return {}
    return {record["name"]: record for record in json.loads(path.read_text())["images"]}


def in_order(records):
    return [records[name] for name, *_ in images() if name in records]


# --- what Mitsuba is given ---------------------------------------------------------------------------------------------


def mesh_of(scene):
    """The mesh as the file holds it."""
    if scene != "spot":
        return meshes.read_ply(HERE / "scenes" / f"{scene}.ply")
    return meshes.outside_mesh(DATA / SPOT["file"], SPOT["subdivisions"], SPOT["albedo"])


def mitsuba_mesh(mesh):
    """One shape with vertex normals and one-sided diffuse albedo from the vertices."""
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict({"type": "diffuse", "reflectance": {"type": "mesh_attribute", "name": "vertex_albedo"}})
    shape = mi.Mesh("mesh", len(mesh.positions), len(mesh.faces), has_vertex_normals=True, props=properties)
    shape.add_attribute("vertex_albedo", 3, mesh.albedo.astype(np.float32).ravel())
    params = mi.traverse(shape)
    params["vertex_positions"] = mesh.positions.astype(np.float32).ravel()
    params["vertex_normals"] = mesh.normals.astype(np.float32).ravel()
    params["faces"] = mesh.faces.astype(np.uint32).ravel()
    params.update()
    return shape


def envmap(light):
    """The emitter of a band-limited light or of a map of ../shared/data/env."""
    if light in MAPS:
        pixels = lights.texel_constant(read_map(light))
    else:
        pixels = lights.map_of(light_named(light))
    return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(pixels, np.float32))}


def read_map(name):
    """Linear radiance [h, w, 3] of a Radiance file."""
    bitmap = mi.Bitmap(str(DATA / "env" / f"{name}.hdr"))
    return np.array(bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False))


def light_named(name):
    return next(light for light in lights.all_lights() if light.name == name)


def sensor(view, size=SIZE):
    return {
        "type": "perspective",
        "fov_axis": "y",
        "fov": view["fov_y_degrees"],
        "near_clip": 0.01,
        "far_clip": 1000.0,
        "to_world": mi.ScalarTransform4f().look_at(view["eye"], view["target"], view["up"]),
        "sampler": {"type": "multijitter"},
        "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"},
                 "pixel_format": "rgb", "component_format": "float32", "sample_border": False},
    }


def scene_of(shape, view, light, bounces):
    """Paths with at most `bounces` reflections after the first surface; no Russian roulette, emitter not seen."""
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 2 + bounces, "rr_depth": 1000, "hide_emitters": True},
        "sensor": sensor(view),
        "light": envmap(light),
        "shape": shape,
    })


# --- rendering ---------------------------------------------------------------------------------------------------------


def make_image(name, scene_name, light, bounces, options):
    spp, view = options.spp, VIEWS[scene_name]
    start = time.time()
    scene = scene_of(mitsuba_mesh(mesh_of(scene_name)), view, light, bounces)
    halves = [render_half(scene, spp // 2, half) for half in (0, 1)]
    path = HERE / "images" / f"{name}.exr"
    image = 0.5 * (halves[0] + halves[1])
    write_exr(image, path)
    record = {"name": name, "image": f"images/{name}.exr", "scene": scene_name, **mesh_record(scene_name), **light_record(light)}
    record |= {"bounces": bounces, "camera": view, "width": SIZE, "height": SIZE, "spp": spp, "variant": options.variant}
    record |= noise(halves, image)
    print(f"{name}: {time.time() - start:.0f} s, {path.stat().st_size} bytes, noise {record['noise_relmse']:.2e}", file=sys.stderr)
    return record


def render_half(scene, spp, half):
    """Mean of `spp` samples in passes of PASS; the two halves use different seeds."""
    total = np.zeros((SIZE, SIZE, 3))
    for index in range(spp // PASS):
        total += np.array(mi.render(scene, spp=PASS, seed=2 * index + half), dtype=np.float64)
    return total / (spp // PASS)


def write_exr(image, path):
    bitmap = mi.Bitmap(image.astype(np.float32), mi.Bitmap.PixelFormat.RGB)
    bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float16, srgb_gamma=False).write(str(path))


def noise(halves, image):
    """Variance of the image, from the difference of its halves, relative to the squared image.

    `noise_relmse` = sum of squares over sum of squares; `noise_relmse_pixel` = mean of d^2 / (value^2 + 0.01 mean^2).
    """
    seen = image.max(2) > 0
    variance, value = 0.25 * (halves[0] - halves[1])[seen] ** 2, image[seen]
    mean = value.mean()
    return {
        "noise_relmse": float(f"{variance.sum() / (value**2).sum():.3g}"),
        "noise_relmse_pixel": float(f"{(variance / (value**2 + 0.01 * mean**2)).mean():.3g}"),
        "mean_radiance": float(f"{mean:.6g}"),
    }


def mesh_record(scene):
    if scene == "spot":
        return {"data_mesh": SPOT["file"], "subdivisions": SPOT["subdivisions"], "albedo": SPOT["albedo"]}
    return {"mesh": f"scenes/{scene}.ply"}


def light_record(light):
    return {"environment": f"env/{light}.hdr"} if light in MAPS else {"light": light}


# --- what we rely on ---------------------------------------------------------------------------------------------------


def check_conventions():
    """Mitsuba's emitter returns the closed form of each light, and its camera is ours; stops if not."""
    for light in lights.all_lights():
        worst, rms = emitter_error(light)
        print(f"{light.name}: emitter against closed form, worst {worst:.1e}, rms {rms:.1e}", file=sys.stderr)
        assert worst < 1e-3 and rms < 2e-4
    for name, view in VIEWS.items():
        error = camera_error(view)
        assert error < 1e-5, f"the camera of {name} is off by {error}"


def emitter_error(light, count=2000):
    """Largest and RMS relative error of the emitter over random directions and channels."""
    emitter = mi.load_dict({"type": "scene", "e": envmap(light.name)}).environment()
    s = lights.random_directions(count, seed=11)
    got = np.array([emitter_eval(emitter, d) for d in s])
    error = got / light.radiance(s) - 1
    return np.abs(error).max(), np.sqrt((error**2).mean())


def emitter_eval(emitter, direction):
    interaction = mi.SurfaceInteraction3f()
    interaction.wi = mi.Vector3f(*(-float(x) for x in direction))
    return np.array(emitter.eval(interaction), float).ravel()


def camera_error(view):
    """Largest difference between Mitsuba's rays and ours over the corners of the image."""
    camera = mi.load_dict(sensor(view))
    worst = 0.0
    for x, y in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.3, 0.8)]:
        ray, _ = camera.sample_ray(0.0, 0.5, mi.Point2f(x, y), mi.Point2f(0.5, 0.5), True)
        worst = max(worst, np.abs(np.array(ray.d, float).ravel() - camera_ray(view, x, y)).max())
    return worst


def camera_ray(view, x, y):
    """Unit direction through the point (x, y) of the image, both 0..1 from the top left; the image is square."""
    eye, target, up = (np.array(view[key]) for key in ("eye", "target", "up"))
    forward = meshes.normalized(target - eye)
    right = meshes.normalized(np.cross(forward, up))
    tan = np.tan(np.radians(view["fov_y_degrees"]) / 2)
    return meshes.normalized(forward + (2 * x - 1) * tan * right + (1 - 2 * y) * tan * np.cross(right, forward))


if __name__ == "__main__":
    main()
