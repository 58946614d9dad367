// Has the motion of a request file planned and, with --execute, made by the arm:  client REQUEST.yaml [--execute]
#include <dds/dds.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>

#include "fjr_msgs.h"

enum { kStep = 10, kAskAgain = 500, kPatience = 10000 };  // [ms]

static fjr_msg_MotionRequest request;  // zeros: all that is not given below, and the end of the document

static dds_entity_t topic(dds_entity_t participant, const char* name, const dds_topic_descriptor_t* type) {
  return dds_create_topic(participant, type, name, NULL, NULL);
}

// The next sample or NULL. The one before, in `loan`, goes back to the reader: it is not to be used any more.
static void* next(dds_entity_t reader, void** loan) {
  dds_sample_info_t info;
  if (*loan) dds_return_loan(reader, loan, 1);
  *loan = NULL;
  return dds_take(reader, loan, &info, 1, 1) == 1 && info.valid_data ? *loan : NULL;
}

static bool is_ours(const fjr_msg_RequestId* id) { return memcmp(id, &request.id, sizeof *id) == 0; }

static bool is_final(const fjr_msg_PlanReply* reply) {
  return reply->state != fjr_msg_STATE_ACCEPTED && reply->reason != fjr_msg_REASON_QUEUE_FULL;
}

int main(int argc, char** argv) {
  const bool execute = argc > 2 && strcmp(argv[2], "--execute") == 0;
  FILE* file = argc > 1 ? fopen(argv[1], "r") : NULL;
  if (!file || fread(request.document, 1, sizeof request.document - 1, file) == 0) {
    return fprintf(stderr, "usage: client REQUEST.yaml [--execute]\n"), 2;
  }
  request.action = execute ? fjr_msg_ACTION_PLAN_AND_EXECUTE : fjr_msg_ACTION_PLAN;
  request.id.number = 1;
  if (getrandom(request.id.client, 16, 0) != 16) return 1;
  char partition[33];
  for (int i = 0; i < 16; ++i) snprintf(partition + 2 * i, 3, "%02x", request.id.client[i]);

  const dds_entity_t all = dds_create_participant(DDS_DOMAIN_DEFAULT, NULL, NULL);
  dds_qos_t* qos = dds_create_qos();
  dds_qset_partition1(qos, partition);
  const dds_entity_t mine = dds_create_subscriber(all, qos, NULL);
  dds_reset_qos(qos);
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  const dds_entity_t requests =
      dds_create_writer(all, topic(all, "fjr/motion_request", &fjr_msg_MotionRequest_desc), qos, NULL);
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  const dds_entity_t replies =
      dds_create_reader(mine, topic(all, "fjr/plan_reply", &fjr_msg_PlanReply_desc), qos, NULL);
  const dds_entity_t results =
      dds_create_reader(all, topic(all, "fjr/execution_result", &fjr_msg_ExecutionResult_desc), qos, NULL);

  void* loan = NULL;
  const fjr_msg_PlanReply* reply = NULL;
  for (int silence = 0; !reply && silence < kPatience; silence += kStep) {
    if (silence % kAskAgain == 0) dds_write(requests, &request);
    dds_sleepfor(DDS_MSECS(kStep));
    while ((reply = next(replies, &loan)) && !(is_ours(&reply->id) && is_final(reply))) silence = 0;
  }
  if (!reply) return fprintf(stderr, "nobody answers: is the service running?\n"), 1;
  if (reply->state != fjr_msg_STATE_SOLVED) return fprintf(stderr, "%s: %s\n", reply->field, reply->sentence), 3;
  const double duration = reply->rows._buffer[reply->rows._length - 1].time;
  printf("duration %g s, %u rows\n", duration, reply->rows._length);
  if (!execute) return 0;

  void* other = NULL;
  const fjr_msg_ExecutionResult* result = NULL;
  for (int waited = 0; !result && waited < 1000 * duration + kPatience; waited += kStep) {
    dds_sleepfor(DDS_MSECS(kStep));
    while ((result = next(results, &other)) && !is_ours(&result->trajectory_id)) continue;
  }
  if (!result) return fprintf(stderr, "the executor has not reported\n"), 1;
  printf("executed: code %d %s\n", result->error_code, result->sentence);
  return result->error_code == fjr_msg_RESULT_SUCCESSFUL ? 0 : 1;
}
