#!/usr/bin/env python3
"""What the rules of "model only what the scene requires" save: a Markdown table on stdout.

Each row is one pipeline over one scene, once as planned and once with --no-prune: median time of a frame, memory of
textures and buffers, relMSE of `hdr` against the path tracer, and how far the two pictures are apart (root of the relMSE
of one against the other; 0: the same bits). The two alternate, so that drift of the machine
favours neither. References are kept in the folder.

Each of the samples looks through another point of the pixel, as a moving camera would: what depends on the view is made
anew for each of them, and the first warms up. Where the scene itself moves, time is that of as many frames, 1/24 s apart, and
the error that of the first moment.

  configs/pruning_table.py [-o FOLDER] [--size WxH] [--samples N] [--repeat N] [--scene SCENE]... [--pipeline PIPELINE]...
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parent.parent
LITTLE = ["grey-room"]
MUCH = ["cornell-box-emissive", "sponza", "cesium-man"]
MOVING = ["cesium-man"]
PIPELINES = ["rsm", "lpv", "lpv-voxel", "ray-march-fast", "ray-march-probes", "cone-trace", "radiance-field",
             "radiance-field-voxel"]


def loom(*arguments):
    program = os.environ.get("LOOM", str(TOP / "build/bin/loom"))
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"loom {' '.join(map(str, arguments))}\n{done.stderr}")
    return done.stdout


def render(folder, scene, pipeline, options, how):
    image, stats = folder / f"{how}.exr", folder / f"{how}.json"
    flags = ["--no-prune"] if how == "full" else []
    loom("render", scene, "-p", pipeline, "-o", image, "--size", options.size, "--samples", options.samples, "--stats",
         stats, *flags)
    if scene in MOVING:
        loom("render", scene, "-p", pipeline, "-o", folder / "moving.exr", "--size", options.size, "--frames",
             options.samples, "--dt", 1 / 24, "--stats", stats, *flags)
    figures = json.loads(stats.read_text())
    return image, figures["frame"]["wall_ms"], figures["memory"]["textures_bytes"]


def error(image, reference):
    return json.loads(loom("compare", image, reference, "--json"))


def apart(pruned, full):
    if pruned.read_bytes() == full.read_bytes():
        return 0.
    figures = error(pruned, full)
    return figures["relmse"] ** .5


def row(folder, scene, pipeline, options):
    times = {"pruned": [], "full": []}
    images, bytes_ = {}, {}
    for _ in range(options.repeat):
        for how in times:
            images[how], ms, bytes_[how] = render(folder, scene, pipeline, options, how)
            times[how].append(ms)
    ms = {how: statistics.median(values) for how, values in times.items()}
    reference = folder / f"{scene}-{options.size}.exr"
    if not reference.exists():
        loom("reference", scene, "-o", reference, "--size", options.size, "--spp", options.spp)
    errors = [f"{error(images[how], reference)['relmse']:.3g}" for how in ("full", "pruned")]
    mb = {how: value / 2**20 for how, value in bytes_.items()}
    return (f"| {scene} | {pipeline} | {ms['full']:.0f} | {ms['pruned']:.0f} | {ms['full'] / ms['pruned']:.1f} | "
            f"{mb['full']:.1f} | {mb['pruned']:.1f} | {mb['full'] / mb['pruned']:.2f} | {errors[0]} | {errors[1]} | "
            f"{apart(images['pruned'], images['full']):.2g} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", dest="folder", type=pathlib.Path, default=pathlib.Path("table-out/pruning"))
    parser.add_argument("--size", default="512x512")
    parser.add_argument("--samples", type=int, default=6, help="of one run")
    parser.add_argument("--repeat", type=int, default=2, help="runs of each, of which the median counts")
    parser.add_argument("--spp", type=int, default=256, help="paths a pixel of the references")
    parser.add_argument("--scene", action="append")
    parser.add_argument("--pipeline", action="append")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    print("| scene | pipeline | ms, --no-prune | ms | ratio | MiB, --no-prune | MiB | ratio | relMSE, --no-prune | "
          "relMSE | apart |")
    print("|" + "---|" * 11, flush=True)
    for scene in options.scene or LITTLE + MUCH:
        for pipeline in options.pipeline or PIPELINES:
            print(row(options.folder, scene, pipeline, options), flush=True)


if __name__ == "__main__":
    main()
