# What lodestone::lodestone is linked with; read when it is built and again when its package is found.
find_package(glm REQUIRED)
find_package(TBB REQUIRED)
find_package(OpenMesh REQUIRED)
find_package(NLopt REQUIRED)
