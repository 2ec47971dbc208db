//! The package `squall_msgs` in the form that colcon builds.

use crate::type_hash::definition;
use messages::ros::DEFINITIONS;
use std::io;
use std::path::Path;

/// The manifest of the package, format 3.
fn manifest() -> String {
    format!(
        r#"<?xml version="1.0"?>
<package format="3">
  <name>squall_msgs</name>
  <version>{version}</version>
  <description>Messages of Squall {version}: pictures, frames, orders and events. Coordinates are north-east-down.</description>
  <maintainer email="squall@localhost">The Squall developers</maintainer>
  <license>MIT</license>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"#,
        version = primitives::VERSION
    )
}

/// The build file of the package.
fn build_file() -> String {
    let files: Vec<String> = DEFINITIONS
        .iter()
        .map(|(name, _)| format!("  \"msg/{name}.msg\"\n"))
        .collect();
    format!(
        "cmake_minimum_required(VERSION 3.8)\nproject(squall_msgs)\n\nfind_package(ament_cmake REQUIRED)\n\
         find_package(rosidl_default_generators REQUIRED)\n\nrosidl_generate_interfaces(${{PROJECT_NAME}}\n{}  \"srv/Reset.srv\"\n)\n\n\
         ament_export_dependencies(rosidl_default_runtime)\nament_package()\n",
        files.concat()
    )
}

/// Writes the package into `folder`, which it creates.
///
/// # Errors
/// If a file cannot be written.
pub fn write(folder: &Path) -> io::Result<()> {
    std::fs::create_dir_all(folder.join("msg"))?;
    std::fs::write(folder.join("package.xml"), manifest())?;
    std::fs::write(folder.join("CMakeLists.txt"), build_file())?;
    for (name, text) in DEFINITIONS {
        std::fs::write(folder.join(format!("msg/{name}.msg")), text)?;
    }
    let [request, response] = ["Request", "Response"].map(|part| {
        let name = format!("squall_msgs/srv/Reset_{part}");
        definition(&name).unwrap_or_default().trim()
    });
    std::fs::create_dir_all(folder.join("srv"))?;
    std::fs::write(
        folder.join("srv/Reset.srv"),
        format!("{request}\n---\n{response}\n"),
    )
}
