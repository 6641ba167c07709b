from setuptools import setup

name = "boundary_planner_ros"
setup(
    name=name,
    version="0.1.0",
    description="A ROS 2 node over boundary_planner",
    license="MIT OR Apache-2.0",
    packages=[name],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{name}"]),
        (f"share/{name}", ["package.xml"]),
        (f"share/{name}/launch", ["launch/boundary.launch.py"]),
        (f"share/{name}/config", ["config/parameters.yaml"]),
    ],
    install_requires=["setuptools"],
    entry_points={"console_scripts": [f"boundary_planner = {name}.node:main"]},
)
