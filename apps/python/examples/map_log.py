#!/usr/bin/env python3
"""Maps a log and draws the map: map_log.py LOG OUTPUT_DIR

LOG is a CARMEN log or a bag of ROS 1 or ROS 2. The picture needs matplotlib.
"""

import argparse
import pathlib

import plumbline


def draw(mapping, path):
    """The map and the robot's way as a PNG; False without matplotlib."""
    try:
        import matplotlib
    except ImportError:
        return False
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(12, 12))
    axes.plot(*mapping.state.points.T, ",", color="black", alpha=0.3)
    axes.plot(*mapping.state.poses[:, :2].T, color="tab:red", linewidth=0.5)
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    figure.savefig(path, dpi=150, bbox_inches="tight")
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("log", type=pathlib.Path)
    parser.add_argument("output_dir", type=pathlib.Path)
    parser.add_argument("--max-scans", type=int, default=0, help="the first ones; 0: all")
    arguments = parser.parse_args()

    graph = plumbline.read_log(arguments.log, max_scans=arguments.max_scans)
    print(graph)
    mapping = plumbline.LogMapping()
    try:
        plumbline.map_log(graph, progress=print, into=mapping)
    except KeyboardInterrupt:
        print("stopped: the best map so far is written")
    print(mapping.report.solver.brief_report())
    print(plumbline.alarm_text(mapping.report.alarms), end="")

    output = arguments.output_dir
    output.mkdir(exist_ok=True)
    graph, state = mapping.graph, mapping.state
    plumbline.write_trajectory(output / "trajectory.tum", graph.timestamps_s, state.poses)
    plumbline.write_points_ply(output / "points.ply", graph, state)
    plumbline.write_map(output / "map", plumbline.build_occupancy_grid(graph, state))
    if not draw(mapping, output / "map.png"):
        print("no picture: matplotlib is not installed")


if __name__ == "__main__":
    main()
