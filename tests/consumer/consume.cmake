# Configures, builds and runs the project beside this file. Set: WORK (folder), CONFIG, FLAGS, and either PREFIX (an
# installed tree) with EMBED_SOURCE, or LODESTONE_SOURCE.
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "failed: ${ARGN}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/project -B ${WORK} -G Ninja -DCMAKE_BUILD_TYPE=${CONFIG}
    -DCMAKE_CXX_FLAGS=${FLAGS} -DCMAKE_PREFIX_PATH=${PREFIX} -DEMBED_SOURCE=${EMBED_SOURCE}
    -DLODESTONE_SOURCE=${LODESTONE_SOURCE})
run(${CMAKE_COMMAND} --build ${WORK})
run(${WORK}/core)
if(PREFIX)
  # The installed program makes what the embedder opens.
  run(${PREFIX}/bin/lodestone generate house --triangles 3000 --texture-size 64 -o ${WORK}/house.obj)
  run(${PREFIX}/bin/lodestone build ${WORK}/house.obj -o ${WORK}/house.lode)
  run(${WORK}/embed ${WORK}/house.lode)
endif()
