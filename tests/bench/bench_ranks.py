#!/usr/bin/env python3
"""bench_ranks.py THREADSTATION SCENE [--spp N] [--turns N]: one picture by one and by two processes.

Prints the median time of drawing (of --turns runs, interleaved) by one process with one and with two threads and by two
processes with one thread each; for twice the samples by two processes, too: what strong and weak scaling lose. Each
process is bound to its own core. Then what each process sends.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import tempfile

TILE_BYTES = 16 * 16 * (3 * 8 + 8 + 4) + 8  # renderer/picture/tile_share.h
TILE_PX = 16


def drawn(program, scene, ranks, threads, spp, folder):
    """The report of one rendering."""
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    command = [program, "render", scene, "--out", str(folder / "a.exr"), "--spp", str(spp), "--threads", str(threads),
               "--fresh", "--json"]
    cores = ",".join(str(core) for core in sorted(os.sched_getaffinity(0))[:max(ranks, threads)])
    start = ["mpirun", "-n", str(ranks), "--bind-to", "core"] if ranks > 1 else ["taskset", "--cpu-list", cores]
    said = subprocess.run(start + command, env=environment, check=True, capture_output=True, text=True)
    return json.loads(said.stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("scene")
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--turns", type=int, default=5)
    asked = parser.parse_args()
    cases = {"1 process, 1 thread": (1, 1, asked.spp), "1 process, 2 threads": (1, 2, asked.spp),
             "2 processes, 1 thread": (2, 1, asked.spp), "2 processes, 1 thread, twice the samples": (2, 1, 2 * asked.spp)}
    times = {name: [] for name in cases}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(asked.turns):
            for name, (ranks, threads, spp) in cases.items():
                report = drawn(asked.program, asked.scene, ranks, threads, spp, pathlib.Path(folder))
                times[name].append(report["render_s"])
    medians = {name: statistics.median(values) for name, values in times.items()}
    one = medians["1 process, 1 thread"]
    for name, median in medians.items():
        print(f"{name:42} {median:7.2f} s   {one / median * cases[name][2] / asked.spp:5.2f} times one thread")
    tiles = -(-report["width_px"] // TILE_PX) * -(-report["height_px"] // TILE_PX)
    passes, samples = 1, 16
    while samples < asked.spp:
        passes, samples = passes + 1, 2 * samples
    for ranks in (2, 100):
        sent = passes * TILE_BYTES * tiles / ranks
        print(f"{ranks} processes: each sends {sent / 1e6:.2f} MB in {passes} passes and is sent "
              f"{passes * 4 * (tiles + 1) / 1e6:.3f} MB; the first is sent {passes * TILE_BYTES * tiles / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
