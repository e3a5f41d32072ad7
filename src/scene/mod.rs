//! Scene files and meshes.
