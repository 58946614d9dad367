# Who may include what: folders are layers, and one adapter stands before each foreign library.
#   cmake -D SOURCE=<repository> -P tests/include_rules.cmake
cmake_minimum_required(VERSION 3.25)

# From the bottom to the top. A file includes headers of its own folder and of folders before it; of a folder's
# subfolders each is a layer of its own. What stands side by side, and is not to know each other, is ruled below.
set(layers
  common/enclosure  # stands by itself
  common
  model
  model/rig
  model/identify
  planner/nlp/chain
  planner/nlp
  planner/collocation
  planner/trajectory
  planner/problem/task
  planner/problem
  planner/request
  planner/control
  planner/certificate
  planner/certificate/proof
  planner/certificate/robust
  planner/identify
  planner/learning
  planner/stop
  planner/ocp
  planner/analysis
  planner/search/settings
  planner/search
  planner/search/explain
  planner  # plan.h, the story of one request
  planner/design
  planner/results
  planner/results/report
  planner/results/export
  planner/store
  planner/library
  planner/batch
  planner/protocol
  planner/dds
  planner/client
  planner/service
  planner/executor
  planner/ros2  # a client of both
  planner/program)

file(GLOB_RECURSE sources RELATIVE ${SOURCE} ${SOURCE}/common/*.h ${SOURCE}/common/*.cc ${SOURCE}/model/*.h
  ${SOURCE}/model/*.cc ${SOURCE}/planner/*.h ${SOURCE}/planner/*.cc)
if(NOT sources)
  message(FATAL_ERROR "no sources in ${SOURCE}")
endif()
set(broken "")

foreach(source ${sources})
  get_filename_component(folder ${source} DIRECTORY)
  list(FIND layers ${folder} own)
  if(own EQUAL -1)
    string(APPEND broken "  ${source}: its folder is no layer\n")
    continue()
  endif()
  file(STRINGS ${SOURCE}/${source} lines REGEX "^[ \t]*#[ \t]*include[ \t]*\"(common|model|planner)/")
  foreach(line ${lines})
    string(REGEX REPLACE ".*\"(.*)/[^/]*\".*" "\\1" included "${line}")
    list(FIND layers ${included} other)
    if(other EQUAL -1 OR other GREATER own)
      string(APPEND broken "  ${source}: ${line}: ${folder} stands below ${included}\n")
    endif()
  endforeach()
endforeach()

# Appends to `broken` what these files include of headers that match `forbidden`.
macro(refuse what files forbidden)
  foreach(source ${files})
    file(STRINGS ${SOURCE}/${source} lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"](${forbidden})")
    foreach(line ${lines})
      string(APPEND broken "  ${source}: ${line}: ${what}\n")
    endforeach()
  endforeach()
endmacro()

# rule(what allowed forbidden): outside the files matching `allowed` nobody includes headers matching `forbidden`.
function(rule what allowed forbidden)
  list(FILTER sources EXCLUDE REGEX "${allowed}")
  refuse("${what}" "${sources}" "${forbidden}")
  set(broken "${broken}" PARENT_SCOPE)
endfunction()

# bars(what barred forbidden): none of the files matching `barred` includes a header matching `forbidden`, although the
# layers would let it.
function(bars what barred forbidden)
  list(FILTER sources INCLUDE REGEX "${barred}")
  refuse("${what}" "${sources}" "${forbidden}")
  set(broken "${broken}" PARENT_SCOPE)
endfunction()

bars("optimisers and schemes know no arm" "^planner/(nlp|collocation)/" "model/|planner/problem/")
bars("a certificate is independent of what it judges" "^planner/certificate/"
  "planner/(nlp|collocation|ocp|search|request)/")

rule("only planner/nlp/ipopt* knows Ipopt" "^planner/nlp/ipopt" "Ip[A-Z][A-Za-z]*\\.hpp|coin(-or)?/")
rule("only planner/certificate and model/rig know SUNDIALS" "^(planner/certificate|model/rig|common/sundials_handles)"
  "sundials/|arkode/|cvodes?/|nvector/|sunmatrix/|sunlinsol/|sunnonlinsol/")
rule("only model/identify/curve_fit.cc knows Ceres" "^model/identify/curve_fit\\.cc$" "ceres/|glog/")
rule("only planner/results/export/mat.cc knows libmatio" "^planner/results/export/mat\\.cc$" "matio")
rule("only planner/store/database.cc knows SQLite" "^planner/store/database\\.cc$" "sqlite3")
rule("only planner/batch/deflate.cc knows zlib" "^planner/batch/deflate\\.cc$" "zlib")
rule("only planner/service/metrics_server.cc knows HTTP" "^planner/service/metrics_server\\.cc$" "httplib")
rule("only planner/dds knows DDS and the wire types" "^planner/dds/"
  "dds/|ddsc/|fjr_(msgs|plan_request|work)\\.h|(follow_joint_trajectory|trajectory_msgs)\\.h")
rule("only what serves, executes or talks to them knows their protocol"
  "^planner/(protocol|dds|client|service|executor|ros2|program)/" "planner/(protocol|dds|client)/")
rule("only what serves or executes logs" "^planner/(protocol|dds|client|service|executor|ros2|program)/" "spdlog/")
rule("only planner/program knows CLI11" "^planner/program/" "CLI/|CLI11")
rule("the rig and identification stand side by side" "^(model/rig|planner/(executor|program))/" "model/rig/")
rule("the rig and identification stand side by side" "^(model/identify|planner/(identify|program))/" "model/identify/")
rule("service and executor stand side by side" "^planner/(service|program)/" "planner/service/")
rule("a plan library knows no batch" "^planner/(library|service|program)/" "planner/library/")
rule("service and batches stand side by side" "^planner/(batch|program)/" "planner/batch/")

if(broken)
  message(FATAL_ERROR "include rules broken:\n${broken}")
endif()
