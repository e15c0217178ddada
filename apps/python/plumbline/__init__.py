"""A factor-graph back end for 2D lidar SLAM in which every laser return stays in the problem.

Units are m, rad and s. `a_from_b` maps coordinates in frame b to frame a. `read_log` and `map_log`
go from a log to a map; `SlamGraph` and `solve` take the measurements of a pipeline of your own.
"""

from ._plumbline import *  # noqa: F401,F403
