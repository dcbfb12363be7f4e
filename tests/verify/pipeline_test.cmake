# SPDX-License-Identifier: GPL-3.0-or-later
# A frictionless one-tip slab and a frictional one from surface to verified forces, by the command line alone.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})

function(run wanted)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT code EQUAL wanted)
    message(FATAL_ERROR "${ARGN}: code ${code}, expected ${wanted}\n${out}${err}")
  endif()
  set(out "${out}" PARENT_SCOPE)
  set(err "${err}" PARENT_SCOPE)
endfunction()

file(WRITE ${FOLDER}/slab.obj "v -0.04 -0.04 -0.03\nv 0.04 -0.04 -0.03\nv 0.04 0.04 -0.03\nv -0.04 0.04 -0.03\n\
v -0.04 -0.04 0\nv 0.04 -0.04 0\nv 0.04 0.04 0\nv -0.04 0.04 0\n\
f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n")
set(common "[body]\nsurface = \"slab.obj\"\n[[tool]]\nname = \"tip\"\nradius = 0.005\n\
[[support]]\nhalf_space = { point = [0, 0, -0.0299], normal = [0, 0, 1] }\n\
[sampling]\nspacing = 0.012\ndepth = 0.003\nnormal_points = 8\n\
within_box = { min = [-0.02, -0.02, -0.001], max = [0.02, 0.02, 0.001] }\n")
file(WRITE ${FOLDER}/slab.toml "${common}")
file(WRITE ${FOLDER}/rough.toml "${common}[contact]\nfriction = 0.3\n")

# Frictionless: no tangential solve, and nothing in the file that the scene does not use.
run(0 ${PALPATE} build slab.toml --json)
string(JSON tangential GET "${out}" bake tangential_solves)
string(JSON normal GET "${out}" bake normal_solves)
string(JSON refused GET "${out}" bake pairs_refused)
if(NOT tangential EQUAL 0 OR normal EQUAL 0 OR NOT refused EQUAL 0)
  message(FATAL_ERROR "frictionless slab: ${normal} normal and ${tangential} tangential solves, ${refused} refused")
endif()
run(0 ${PALPATE} inspect slab.palp)
run(0 ${PALPATE} inspect slab.palp --json)
string(JSON sections GET "${out}" sections)
foreach(name IN ITEMS friction tool_patches search)
  if("${sections}" MATCHES "\"${name}\"")
    message(FATAL_ERROR "frictionless slab: its file has a section ${name}:\n${sections}")
  endif()
endforeach()

run(0 ${PALPATE} verify slab.toml --count 8 --report report.json --max-p95 0.12 --json)
string(JSON median GET "${out}" error median)
string(JSON count GET "${out}" error count)
if(median GREATER 0.03 OR count LESS 40)
  message(FATAL_ERROR "slab: median error ${median} over ${count} forces")
endif()
run(0 ${PALPATE} verify slab.palp --samples report.json --max-p95 0.12)
run(5 ${PALPATE} verify slab.palp --samples report.json --max-p95 1e-9)
run(1 ${PALPATE} verify slab.palp)
run(4 ${PALPATE} verify slab.palp --samples missing.json)
file(WRITE ${FOLDER}/broken.json "{\"held_out\": [{\"tool\": 0}]}")
run(2 ${PALPATE} verify slab.palp --samples broken.json)

# A second build has nothing to do and gives the same bytes; one thread and two give the same bytes.
file(SHA256 ${FOLDER}/slab.palp first)
run(0 ${PALPATE} build slab.toml)
file(SHA256 ${FOLDER}/slab.palp second)
run(0 ${PALPATE} build slab.toml --threads 1 --work other.work --output other.palp)
file(SHA256 ${FOLDER}/other.palp third)
if(NOT first STREQUAL second OR NOT first STREQUAL third)
  message(FATAL_ERROR "slab: different bytes on a second run or on one thread")
endif()

# With friction the sideways sections are there, and sideways pushes are verified too.
run(0 ${PALPATE} build rough.toml --json)
string(JSON tangential GET "${out}" bake tangential_solves)
if(tangential EQUAL 0)
  message(FATAL_ERROR "rough slab: no tangential solve")
endif()
run(0 ${PALPATE} verify rough.toml --count 4 --max-p95 0.12 --json)
string(JSON count GET "${out}" error_sideways count)
if(count LESS 8)
  message(FATAL_ERROR "rough slab: ${count} sideways forces verified")
endif()

# The CMake function as a user's project has it.
run(0 ${CMAKE_COMMAND} -S ${CONSUMER} -B consumer -DFOLDER=${FOLDER} -Dpalpate_DIR=${MODULES}
    -Dpalpate_EXECUTABLE=${PALPATE})
run(0 ${CMAKE_CTEST_COMMAND} --test-dir consumer --output-on-failure)
