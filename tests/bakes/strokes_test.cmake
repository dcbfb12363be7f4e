# SPDX-License-Identifier: GPL-3.0-or-later
# A scene of the coupled model (NAME.toml.in), baked; whole motions at a few of its contacts, solved with Coulomb
# friction and played. The 95th percentile of the force's error is held to 5 % where the contact sticks, 10 % where it
# slips in part, 5 % where it slides.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
set(MESH 0.3)
set(HALF 0.022)
set(POINTS 12)
configure_file(${CMAKE_CURRENT_LIST_DIR}/${NAME}.toml.in ${FOLDER}/${NAME}.toml @ONLY)

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

run(build ${NAME}.toml)
message(STATUS "${out}")
run(verify ${NAME}.toml --strokes --contacts ${CONTACTS} --plot ${NAME}.svg --json)
foreach(bound IN ITEMS "sticking;0.05" "partial slip;0.10" "sliding;0.05")
  list(GET bound 0 state)
  list(GET bound 1 most)
  foreach(field IN ITEMS count median p95 worst)
    string(JSON ${field} GET "${out}" error "${state}" ${field})
  endforeach()
  message(STATUS "${NAME}, ${state}: ${count} forces, error median ${median}, p95 ${p95}, worst ${worst}")
  if(count LESS 20 OR p95 GREATER most)
    message(FATAL_ERROR "${NAME}, ${state}: ${count} forces compared, 95th percentile ${p95}, allowed ${most}")
  endif()
endforeach()
