"""Start and activate the node: ros2 launch planescope_ros planes.launch.py depth:=/camera/camera/depth"""

import lifecycle_msgs.msg
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, RegisterEventHandler
from launch.events import matches_action
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import LifecycleNode
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState


def generate_launch_description():
    depth = LaunchConfiguration("depth")
    node = LifecycleNode(
        package="planescope_ros",
        executable="planes_node",
        name=LaunchConfiguration("name"),
        namespace="",
        output="screen",
        parameters=[{"foot_radius_m": LaunchConfiguration("foot_radius_m")}],
        remappings=[
            ("depth/image", PathJoinSubstitution([depth, LaunchConfiguration("image")])),
            ("depth/camera_info", PathJoinSubstitution([depth, "camera_info"])),
        ],
    )

    def change(transition):
        return EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node), transition_id=transition))

    transition = lifecycle_msgs.msg.Transition
    activate = OnStateTransition(
        target_lifecycle_node=node,
        start_state="configuring",
        goal_state="inactive",
        entities=[change(transition.TRANSITION_ACTIVATE)],
    )
    return LaunchDescription(
        [
            DeclareLaunchArgument("depth", default_value="/camera/camera/depth", description="Namespace of image and camera_info"),
            DeclareLaunchArgument("image", default_value="image_rect_raw", description="Depth image in the namespace"),
            DeclareLaunchArgument("name", default_value="planescope", description="Name of the node"),
            DeclareLaunchArgument("foot_radius_m", default_value="0.0", description="Foot radius; 0: no footholds"),
            RegisterEventHandler(activate),  # before the node can reach that state
            node,
            change(transition.TRANSITION_CONFIGURE),
        ]
    )
