# What other programs may include; docs/library.md says what each is for. What these include in turn is installed with
# them, but may change without notice.
set(FJR_PUBLIC_HEADERS
  common/input_error.h
  model/parameters.h
  model/dynamics.h
  model/kinematics.h
  model/flatness.h
  model/identify/from_files.h
  planner/request/request.h
  planner/plan.h
  planner/trajectory/trajectory.h
  planner/certificate/certificate.h
  planner/certificate/simulation.h
  planner/results/plan_json.h
  planner/results/report/plan_page.h
  planner/client/client.h)
