// Another program on fjr's topic with a type of its own:  stranger DOMAIN TYPE_NAME
#include <dds/dds.h>
#include <other_types.h>

#include <array>
#include <cstdio>
#include <cstdlib>

int main(int, char** argv) {
  dds_topic_descriptor_t type = fjr_msg_PlanRequest_desc;
  type.m_typename = argv[2];
  const dds_entity_t participant =
      dds_create_participant(static_cast<dds_domainid_t>(std::atoi(argv[1])), nullptr, nullptr);
  const dds_entity_t topic = dds_create_topic(participant, &type, "fjr/plan_request", nullptr, nullptr);
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  const dds_entity_t writer = dds_create_writer(participant, topic, qos, nullptr);
  dds_delete_qos(qos);
  std::array<double, 100> values{};
  char text[] = "something else";
  fjr_msg_PlanRequest sample{7, text, {100, 100, values.data(), false}};
  int written = 0;
  for (int i = 0; i < 100; ++i) {
    written += dds_write(writer, &sample) == DDS_RETCODE_OK ? 1 : 0;
    dds_sleepfor(DDS_MSECS(10));
  }
  std::printf("written=%d\n", written);
  dds_delete(participant);
  return writer > 0 && written == 100 ? 0 : 1;
}
