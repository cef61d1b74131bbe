"""MRPT's rbpf-slam on one log: a Rao-Blackwellised particle filter on grid maps.

Grisetti, Stachniss, Burgard, IEEE Trans. Robot. 23 (2007) is the method of Gmapping and of the
proposal called so here; Blanco, González, Fernández-Madrigal, IJRR 29 (2010) the optimal
sampling. With the random seed given, two runs give the same map.
"""

import dataclasses
import math
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from ...errors import BadFile, CheckFailed
from . import rawlog

SEED = 1
RESOLUTION_M = 0.1
OCCUPIED = 0.4              # a cell that is free with less than this probability is a wall
PATIENCE_S = 600
LINES = 3                   # of an engine that died
TRACE = re.compile(r"\[\d+ *\] |Call stack|Press any key")      # tells nobody anything


@dataclasses.dataclass(frozen=True)
class Engine:
    """One step of the ladder: how much of the heading the scans may take over.

    algorithm: MRPT's PF_algorithm; power: its powFactor, that of a particle's likelihood;
    motion: see rawlog.movement
    """

    name: str
    algorithm: int
    particles: int
    motion: tuple
    power: float = 1.0


# 0.2° of heading a metre and 1 % of the distance and of the turn: wheels with a good gyro.
ODOMETRY = (0.01, 0.0, math.radians(0.2), 0.01, 0.0, 0.0)
FLAT = 0.01                 # powFactor of MRPT's own settings where scans only weigh particles
LADDER = (Engine("no SLAM", 0, 1, (0.0,) * 6),
          Engine("optimal sampling", 3, 15, ODOMETRY, FLAT),
          Engine("Gmapping proposal", 2, 15, ODOMETRY))

INI = """[MappingApplication]
logOutput_dir={output}
rawlog_offset=0
LOG_FREQUENCY=0
SAVE_MAP_IMAGES=0
SAVE_3D_SCENE=0
SAVE_POSE_LOG=0
SHOW_PROGRESS_IN_WINDOW=0
RANDOM_SEED={seed}
verbosity=WARN
verbosity_level=WARN
insertionLinDistance=-1
insertionAngDistance_deg=-1
localizeLinDistance=-1
localizeAngDistance_deg=-1
PF_algorithm={algorithm}
adaptiveSampleSize=0
resamplingMethod=3
sampleSize={particles}
BETA=0.5
powFactor={power}
pfAuxFilterOptimal_MaximumSearchSamples=250
pfOptimalProposal_mapSelection=0
occupancyGrid_count=1
gasGrid_count=0
landmarksMap_count=0
beaconMap_count=0
pointsMap_count=0
likelihoodMapSelection=-1
KLD_maxSampleSize=150
KLD_minSampleSize=15
KLD_binSize_XY=0.03
KLD_binSize_PHI_deg=1
KLD_delta=0.001
KLD_epsilon=0.5
ICP_algorithm=0
maxIterations=60
thresholdDist={far}
thresholdAng_DEG=5
ALFA=0.5
smallestThresholdDist={resolution}
onlyClosestCorrespondences=1

[MappingApplication_occupancyGrid_00_creationOpts]
resolution={resolution}
disableSaveAs3DObject=0

[MappingApplication_occupancyGrid_00_insertOpts]
mapAltitude=0
useMapAltitude=0
maxDistanceInsertion={reach}
maxOccupancyUpdateCertainty=0.6
considerInvalidRangesAsFreeSpace=0
minLaserScanNoiseStd=0.001
wideningBeamsWithDistance=0

[MappingApplication_occupancyGrid_00_likelihoodOpts]
likelihoodMethod=4
LF_decimation=5
LF_stdHit=0.2
LF_maxCorrsDistance=0.3
LF_zHit=0.999
LF_zRandom=0.001
LF_maxRange=30
LF_alternateAverageMethod=0
enableLikelihoodCache=1
"""


@dataclasses.dataclass(frozen=True)
class Map:
    """path (n, 3) m, m, rad, one pose a scan; walls (m, 2) m, the middles of occupied cells;
    grid (rows, columns) probability that a cell is free, its first row lowest; limits x0 x1
    y0 y1 in m; all in the frame of the first pose."""

    path: np.ndarray
    walls: np.ndarray
    grid: np.ndarray
    limits: tuple


def run(program, engine, odometry, scans, t_s, aperture=2.0 * math.pi, reach_m=8.0,
        resolution=RESOLUTION_M, seed=SEED, keep=None):
    """Map of one log; CheckFailed with the engine's last lines where it dies.

    keep: a folder that log and settings stay in, for whoever wants to run the engine again
    """
    with tempfile.TemporaryDirectory(prefix="sixflip-map-") as work:
        work = Path(work)
        if keep:
            keep = keep.resolve()       # the engine runs in a folder of its own
            keep.mkdir(parents=True, exist_ok=True)
        log, output = (keep or work) / "drive.rawlog", work / "out"
        settings = (keep or work) / "rbpf-slam.ini"
        rawlog.write(log, odometry, scans, t_s, engine.motion, aperture, reach_m)
        settings.write_text(INI.format(
            output=output, seed=seed, algorithm=engine.algorithm, particles=engine.particles,
            power=engine.power, resolution=resolution, far=10.0 * resolution, reach=reach_m))
        start(program, [str(settings), str(log)], engine.name, work)
        return read(output, len(t_s))


def start(program, words, name, work):
    """Run the engine to its end."""
    try:
        answer = subprocess.run([program, *words], cwd=work, stdin=subprocess.DEVNULL,
                                capture_output=True, timeout=PATIENCE_S)
    except subprocess.TimeoutExpired:
        raise CheckFailed("rbpf-slam (%s) was not done after %d s" % (name, PATIENCE_S)) from None
    except OSError as error:
        raise CheckFailed("rbpf-slam (%s) does not start: %s" % (name, error)) from None
    if answer.returncode:
        said = (answer.stdout + answer.stderr).decode(errors="replace").splitlines()
        said = [line.strip() for line in said if line.strip() and not TRACE.match(line)]
        last = " / ".join(said[-LINES:])
        how = ("signal %d" % -answer.returncode if answer.returncode < 0
               else "exit %d" % answer.returncode)
        raise CheckFailed("rbpf-slam (%s) died with %s: %s" % (name, how, last or "no word"))


def read(output, poses):
    """The Map an engine left; BadFile where it is none of so many poses."""
    from matplotlib import image
    try:
        path = np.loadtxt(output / "most_likely_path.txt", ndmin=2)
        (picture,) = output.glob("finalMap*.png")
        (limits,) = output.glob("finalMap*_limits.txt")
        x0, x1, y0, y1 = np.loadtxt(limits, comments="%")
        pixels = image.imread(picture)
    except (OSError, ValueError) as error:
        raise BadFile("%s: rbpf-slam left no map: %s" % (output, error)) from None
    path = path[-poses:]
    if path.shape != (poses, 3):
        raise BadFile("%s: rbpf-slam left %d poses, expected %d; its log is cut short"
                      % (output, len(path), poses))
    grid = (pixels[..., 0] if pixels.ndim == 3 else pixels)[::-1]
    rows, columns = np.nonzero(grid < OCCUPIED)
    cell = (x1 - x0) / grid.shape[1]
    walls = np.stack([x0 + (columns + 0.5) * cell, y0 + (rows + 0.5) * cell], axis=1)
    return Map(path, walls, grid, (x0, x1, y0, y1))
