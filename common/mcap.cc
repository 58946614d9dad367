#include "common/mcap.h"

#include <algorithm>
#include <utility>

namespace fjr {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr std::size_t kChunkSize = 1 << 20;  // bytes of messages after which another chunk begins

enum class Op : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kSummaryOffset = 14,
  kDataEnd = 15,
};

// Little-endian.
template <class Number>
void put(std::string& to, Number value) {
  for (std::size_t i = 0; i < sizeof(Number); ++i) to += static_cast<char>((value >> (8 * i)) & 0xFF);
}
void put16(std::string& to, std::uint16_t value) {
  to += static_cast<char>(value & 0xFF);
  to += static_cast<char>(value >> 8);
}
void put_text(std::string& to, std::string_view text) {
  put(to, static_cast<std::uint32_t>(text.size()));
  to += text;
}

std::string record(Op op, const std::string& content) {
  std::string bytes(1, static_cast<char>(op));
  put(bytes, static_cast<std::uint64_t>(content.size()));
  return bytes + content;
}

// A chunk that is being filled.
struct Chunk {
  std::string records;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index;  // time, offset
  std::uint64_t first = 0, last = 0;
};

// What is at the end of the file, to be found from there.
struct Summary {
  std::string chunk_indexes;
  std::map<std::uint16_t, std::uint64_t> counts;
  std::uint32_t chunks = 0;
};

void write_chunk(const Chunk& chunk, std::string& file, Summary& summary) {
  if (chunk.records.empty()) return;
  const std::uint64_t start = file.size();
  const auto size = static_cast<std::uint64_t>(chunk.records.size());
  std::string content;
  put(content, chunk.first);
  put(content, chunk.last);
  put(content, size);
  put(content, std::uint32_t{0});  // no checksum
  put_text(content, "");           // no compression
  put(content, size);
  file += record(Op::kChunk, content + chunk.records);
  const std::uint64_t length = file.size() - start;

  std::string offsets;
  const std::uint64_t indexes = file.size();
  for (const auto& [topic, entries] : chunk.index) {
    put16(offsets, topic);
    put(offsets, static_cast<std::uint64_t>(file.size()));
    std::string list, message_index;
    for (const auto& [time, offset] : entries) {
      put(list, time);
      put(list, offset);
    }
    put16(message_index, topic);
    put_text(message_index, list);
    file += record(Op::kMessageIndex, message_index);
  }

  std::string chunk_index;
  put(chunk_index, chunk.first);
  put(chunk_index, chunk.last);
  put(chunk_index, start);
  put(chunk_index, length);
  put_text(chunk_index, offsets);
  put(chunk_index, static_cast<std::uint64_t>(file.size()) - indexes);
  put_text(chunk_index, "");
  put(chunk_index, size);
  put(chunk_index, size);
  summary.chunk_indexes += record(Op::kChunkIndex, chunk_index);
  ++summary.chunks;
}

std::string statistics(const Summary& summary, std::uint16_t topics, std::uint64_t messages, std::uint64_t first,
                       std::uint64_t last) {
  std::string content, counts;
  put(content, messages);
  put16(content, topics);
  put(content, static_cast<std::uint32_t>(topics));
  put(content, std::uint32_t{0});  // attachments
  put(content, std::uint32_t{0});  // metadata
  put(content, summary.chunks);
  put(content, first);
  put(content, last);
  for (const auto& [topic, count] : summary.counts) {
    put16(counts, topic);
    put(counts, count);
  }
  put_text(content, counts);
  return record(Op::kStatistics, content);
}

}  // namespace

McapWriter::McapWriter(std::string_view profile, std::string_view library) {
  put_text(header_, profile);
  put_text(header_, library);
}

std::uint16_t McapWriter::add_topic(std::string_view topic, std::string_view message_encoding,
                                    std::string_view schema_name, std::string_view schema_encoding,
                                    std::string_view schema) {
  const std::uint16_t id = ++topics_;  // schemas and channels count alike, from 1
  std::string content;
  put16(content, id);
  put_text(content, schema_name);
  put_text(content, schema_encoding);
  put_text(content, schema);
  schemas_ += record(Op::kSchema, content);
  content.clear();
  put16(content, id);
  put16(content, id);
  put_text(content, topic);
  put_text(content, message_encoding);
  put_text(content, "");  // metadata
  channels_ += record(Op::kChannel, content);
  return id;
}

void McapWriter::add(std::uint16_t topic, std::uint64_t time, std::string message) {
  messages_.push_back({topic, time, std::move(message)});
}

std::string McapWriter::finish() {
  std::stable_sort(messages_.begin(), messages_.end(),
                   [](const Message& a, const Message& b) { return a.time < b.time; });
  std::string file(kMagic);
  file += record(Op::kHeader, header_);
  file += schemas_ + channels_;
  Summary summary;
  Chunk chunk;
  for (const Message& message : messages_) {
    if (chunk.records.size() >= kChunkSize) {
      write_chunk(chunk, file, summary);
      chunk = {};
    }
    if (chunk.records.empty()) chunk.first = message.time;
    chunk.last = message.time;
    chunk.index[message.topic].emplace_back(message.time, chunk.records.size());
    std::string content;
    put16(content, message.topic);
    put(content, static_cast<std::uint32_t>(summary.counts[message.topic]++));
    put(content, message.time);
    put(content, message.time);
    chunk.records += record(Op::kMessage, content + message.data);
  }
  write_chunk(chunk, file, summary);
  file += record(Op::kDataEnd, std::string(4, '\0'));  // no checksum

  const std::uint64_t summary_start = file.size();
  std::string offsets;
  const auto add_group = [&](Op op, const std::string& records) {
    if (records.empty()) return;
    std::string content(1, static_cast<char>(op));
    put(content, static_cast<std::uint64_t>(file.size()));
    put(content, static_cast<std::uint64_t>(records.size()));
    offsets += record(Op::kSummaryOffset, content);
    file += records;
  };
  add_group(Op::kSchema, schemas_);
  add_group(Op::kChannel, channels_);
  const std::uint64_t first = messages_.empty() ? 0 : messages_.front().time;
  const std::uint64_t last = messages_.empty() ? 0 : messages_.back().time;
  add_group(Op::kStatistics, statistics(summary, topics_, messages_.size(), first, last));
  add_group(Op::kChunkIndex, summary.chunk_indexes);
  const std::uint64_t offset_start = file.size();
  file += offsets;
  std::string footer;
  put(footer, summary_start);
  put(footer, offset_start);
  put(footer, std::uint32_t{0});  // no checksum
  file += record(Op::kFooter, footer);
  return file += kMagic;
}

}  // namespace fjr
