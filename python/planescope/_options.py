"""Options as a typed dictionary, generated from the registry by tests/python/options_test.py."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypedDict

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._frames import Gravity


class OptionsWithoutGravity(TypedDict, total=False):
    """Options of segment() and segment_cloud(), which have a separate argument `gravity`.

    Example:
        >>> options: ps.OptionsWithoutGravity = {"max_range_m": 2.5, "foot_radius_m": 0.08}
        >>> planes, labels = ps.segment(depth, K, **options)
    """

    # Depth z beyond which pixels are ignored (depth images) [m]
    max_range_m: float
    # Ignore points farther than max_range_m from the origin (clouds)
    range_for_clouds: bool
    # Minimum edge of the octree cube; doubled until it contains the range [m]
    cube_edge_m: float
    # Voxel edge; 0 makes every point a voxel [m]
    voxel_size_m: float
    # Octree depth for a cube of cube_edge_m: 8 gives leaves of 1.25 cm in 3.2 m [levels]
    base_depth: int
    # Maximum camera tilt that the gravity estimate allows [deg]
    gravity_max_tilt_deg: float
    # Classifier that labels points horizontal or vertical: a network, PCA normals, or ground truth
    classifier: str
    # Points in each local plane fit, including the point itself [points]
    pca_neighbours: int
    # Eq. (1): horizontal if the normal is within this angle of gravity [deg]
    pca_max_angle_deg: float
    # Method that finds planes: ours, or one to compare with
    method: Literal["ours", "region-growing"]
    # Criterion 1: maximum number of outliers in a node [points]
    theta_n_out: int
    # Criterion 1: maximum share of outliers in a node [share]
    theta_r_out: float
    # Criterion 2: minimum number of inliers in a node [points]
    theta_n_in: int
    # Criterion 3: maximum error e_n of the inliers' plane fit [m2]
    theta_e_n_m2: float
    # e_n is the smallest eigenvalue of the scatter matrix, as in the paper, or divided by N
    mse_normalization: Literal["scatter", "mean"]
    # Criterion 4: minimum coplanarity of two merged candidates
    theta_coplane: float
    # Criterion 4: also evaluate its third line, with the candidate's normal
    criterion4_n2: bool
    # Criterion 4: maximum |n . dmu|; 0 disables the test [m]
    merge_offset_m: float
    # Coplanar plane that a candidate is merged into
    merge_partner: Literal["first", "best"]
    # Maximum distance at which an unassigned point is assigned to a plane [m]
    leftover_distance_m: float
    # Use h and v labels; off: one label for all points, the paper's "w/o PC"
    use_labels: bool
    # Cube centered by the cloud stage, or starting at the minimum corner of the points
    cube_anchor: Literal["center", "min_corner"]
    # Criterion 3: maximum variance of a cell, relative to the expected variance
    flat: float
    # Low-frequency depth error, relative to the measured one
    bow: float
    # Cost of a plane: regions merge when their misfit costs less
    merge_cost: float
    # Depth images, Criterion 1: maximum cost of one plane instead of two, as a share of merge_cost [share]
    two_planes: float
    # Depth images, Criterion 2: minimum share of a cell's pixels on its plane [share]
    filled: float
    # Depth images: lateral error of a pixel [px]
    lateral_px: float
    # Depth images: cost of an unassigned pixel, as a residual [sigma]
    reach_sigma: float
    # Depth images: cost limit for merging parts separated by an occlusion, as a share of merge_cost [share]
    hidden_share: float
    # Depth images: minimum worth of a plane, in pixels of a plane with 1 % RMS (image 640 px wide) [px]
    worth_px: float
    # Depth images: planes with a smaller margin are undecided
    undecided: float
    # Clouds: minimum noise sigma, in point spacings [spacings]
    resolution: float
    # Clouds: cost of an unassigned point, as a distance [sigma]
    point_reach_sigma: float
    # Clouds: extra distance of a point from a plane with the other label [sigma]
    label_sigma: float
    # Clouds: cost of a plane [sigma2]
    plane_cost: float
    # Region growing: cell edge in depth images [px]
    region_patch_px: float
    # Region growing: cell edge in unordered clouds [m]
    region_voxel_size_m: float
    # Region growing: threshold for planar region identification [m2]
    region_threshold_m2: float
    # Region growing: minimum cosine between the normals of merged regions
    region_merge_threshold: float
    # Region growing: refine points along the borders of regions
    region_refine_boundaries: bool
    # Radius of the foot, or of the circle around it (--foot); 0 disables footholds [m]
    foot_radius_m: float
    # Extra distance of the foot from borders and holes [m]
    foot_margin_m: float
    # Unmeasured holes up to this share of the foot's circle are ignored [share]
    foot_unknown_share: float
    # Maximum distance of a foothold's surface from the plane [m]
    foot_max_off_m: float
    # Steppable planes: maximum slope [deg]
    foot_max_slope_deg: float
    # Steppable planes: minimum area for the center of the foot [m2]
    foot_min_area_m2: float
    # Steppable planes: maximum RMS of their height [m]
    foot_max_rough_m: float
    # Steppable planes: minimum measured share of the outline [share]
    foot_min_support: float
    # Minimum rise of a step [m]
    stairs_rise_min_m: float
    # Maximum rise of a step [m]
    stairs_rise_max_m: float
    # Minimum going, from nosing to nosing [m]
    stairs_going_min_m: float
    # Maximum going, from nosing to nosing [m]
    stairs_going_max_m: float
    # Minimum visible width of a nosing [m]
    stairs_width_min_m: float
    # Maximum difference in rise between neighboring steps [m]
    stairs_rise_spread_m: float
    # Maximum difference in going between neighboring steps [m]
    stairs_going_spread_m: float
    # Maximum angle between the nosings of a flight [deg]
    stairs_turn_deg: float
    # Maximum gap between a level and the nosing behind it, beyond the part hidden by the upper one [m]
    stairs_gap_m: float
    # Minimum tilt of a ramp; its height must also change by more than stairs_rise_min_m [deg]
    stairs_level_deg: float
    # Minimum depth of a landing, in goings of its flight [goings]
    stairs_landing_goings: float
    # Minimum width of a kerb, a single step [m]
    stairs_kerb_width_m: float
    # Minimum depth of the levels before and behind a kerb [m]
    stairs_kerb_depth_m: float
    # Minimum area of the floor, the lowest level [m2]
    stairs_floor_m2: float


class Options(OptionsWithoutGravity, total=False):
    """Keywords of Segmenter, make_map() and Mapper.

    Example:
        >>> options: ps.Options = {"gravity": "imu", "theta_n_in": 10}
        >>> segmenter = ps.Segmenter(**options)
    """

    # Gravity direction in the frame of the sensor or cloud; none: do not distinguish horizontal from vertical
    gravity: ArrayLike | Gravity | str
