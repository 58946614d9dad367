# Who may include what (one adapter per foreign library, and one direction between the parts).
#   cmake -D SOURCE=<repository> -P tests/include_rules.cmake
cmake_minimum_required(VERSION 3.25)

file(GLOB_RECURSE sources RELATIVE ${SOURCE} ${SOURCE}/model/*.h ${SOURCE}/model/*.cc ${SOURCE}/planner/*.h
  ${SOURCE}/planner/*.cc)
if(NOT sources)
  message(FATAL_ERROR "no sources in ${SOURCE}")
endif()
set(broken "")

# rule(what allowed forbidden): outside the files matching `allowed` nobody includes headers matching `forbidden`.
function(rule what allowed forbidden)
  foreach(source ${sources})
    if(source MATCHES "${allowed}")
      continue()
    endif()
    file(STRINGS ${SOURCE}/${source} lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"](${forbidden})")
    foreach(line ${lines})
      string(APPEND broken "  ${source}: ${line}: ${what}\n")
    endforeach()
  endforeach()
  set(broken "${broken}" PARENT_SCOPE)
endfunction()

rule("only planner/solver/ipopt* knows Ipopt" "^planner/solver/ipopt" "Ip[A-Z][A-Za-z]*\\.hpp|coin(-or)?/")
rule("only planner/certificate and model/rig know SUNDIALS" "^(planner/certificate|model/rig)/"
  "sundials/|arkode/|cvodes?/|nvector/|sunmatrix/|sunlinsol/|sunnonlinsol/")
rule("only model/identify/curve_fit.cc knows Ceres" "^model/identify/curve_fit\\.cc$" "ceres/|glog/")
rule("model stands below planner" "^planner/" "planner/")
rule("only planner/service/dds and planner/executor/dds know DDS and the wire types" "^planner/(service|executor)/dds/"
  "dds/|ddsc/|fjr_(msgs|plan_request)\\.h|trajectory_msgs\\.h")
rule("only service, executor and program know planner/service" "^planner/(service|executor|program)/" "planner/service/")
rule("only service, executor and program log" "^planner/(service|executor|program)/" "spdlog/")
rule("only planner/program knows CLI11" "^planner/program/" "CLI/|CLI11")
rule("the rig and identification stand side by side" "^(model/rig|planner)/" "model/rig/(rig|experiments|record|simulated_arm|normal|rig_file)")
rule("the rig and identification stand side by side" "^(model/identify|planner/program)/" "model/identify/")
rule("nothing stands above planner/program" "^planner/program/" "planner/program/")

if(broken)
  message(FATAL_ERROR "include rules broken:\n${broken}")
endif()
