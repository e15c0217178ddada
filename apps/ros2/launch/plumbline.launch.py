"""Starts the node and, unless autostart is false, configures and activates it."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, RegisterEventHandler
from launch.conditions import IfCondition
from launch.events import matches_action
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import LifecycleNode
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState
from launch_ros.substitutions import FindPackageShare
from lifecycle_msgs.msg import Transition


def generate_launch_description():
    default_parameters = PathJoinSubstitution(
        [FindPackageShare("plumbline_ros"), "config", "plumbline.yaml"])
    node = LifecycleNode(
        package="plumbline_ros",
        executable="plumbline_node",
        name="plumbline",
        namespace=LaunchConfiguration("namespace"),
        parameters=[LaunchConfiguration("params_file"),
                    {"use_sim_time": LaunchConfiguration("use_sim_time")}],
        output="screen")

    def change_state(transition_id, **kwargs):
        return EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node),
                                           transition_id=transition_id), **kwargs)

    autostart = IfCondition(LaunchConfiguration("autostart"))
    configure = change_state(Transition.TRANSITION_CONFIGURE, condition=autostart)
    activate = RegisterEventHandler(
        OnStateTransition(target_lifecycle_node=node, start_state="configuring",
                          goal_state="inactive",
                          entities=[change_state(Transition.TRANSITION_ACTIVATE)]),
        condition=autostart)
    return LaunchDescription([
        DeclareLaunchArgument("namespace", default_value=""),
        DeclareLaunchArgument("params_file", default_value=default_parameters),
        DeclareLaunchArgument("use_sim_time", default_value="false"),
        DeclareLaunchArgument("autostart", default_value="true"),
        activate,
        node,
        configure,
    ])
