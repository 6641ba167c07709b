"""A ROS 2 node over boundary_planner."""
