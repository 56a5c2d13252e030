"""Cooks a planned world on a Dask cluster, whose workers see the world's folder and the command:

    pip install dask distributed
    gtx world plan MODEL... -o WORLD
    python world_dask.py WORLD [SCHEDULER:PORT]

Without a scheduler it starts two workers on this machine.
"""
import json
import os
import subprocess
import sys

import distributed


def step(world, *names):
    """One process; what it needs is there, for Dask passes on the steps before it."""
    words = [os.environ.get("GTX", "gtx"), "world", names[0], world, *names[1:]]
    subprocess.run(words + ["-q", "--threads", "1"], check=True)


def after(others, world, *names):
    return step(world, *names)


def main(world, scheduler=None):
    with open(os.path.join(world, "plan.json")) as file:
        tiles = json.load(file)["tiles"]
    cluster = scheduler or distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None)
    with distributed.Client(cluster) as client:
        split = client.submit(after, [], world, "split", pure=False)
        done = {t["name"]: client.submit(after, [split], world, "cook", t["name"], pure=False)
                for t in tiles if t["leaf"]}
        for depth in range(max(t["depth"] for t in tiles), -1, -1):
            below = list(done.values())  # a tile's ring lies in its neighbours' low surfaces
            for tile in tiles:
                if tile["depth"] != depth or tile["leaf"]:
                    continue
                merged = client.submit(after, below, world, "merge", tile["name"], pure=False)
                done[tile["name"]] = client.submit(
                    after, [merged], world, "cook", tile["name"], pure=False)
        client.submit(after, list(done.values()), world, "index", pure=False).result()


if __name__ == "__main__":
    main(*sys.argv[1:])
