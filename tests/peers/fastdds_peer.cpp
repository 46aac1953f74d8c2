// A peer on Fast DDS, on loopback only: stands for a ROS 2 node under rmw_fastrtps_cpp.
//
//   fastdds_peer read  --domain N --topic /t[,/u…] --type T [--best-effort] [--transient-local] [--depth D] [--expect K]
//   fastdds_peer write --domain N --topic /t --type T --payload-file FILE|- [--count K] [--rate HZ]
//                      [--best-effort] [--transient-local] [--depth D]
//   fastdds_peer call  --domain N --service /s --type T --request HEX [--repeat K]
//
// Every command takes `--seconds S`, the bound of all its waiting together (default 10). Types are named as DDS does,
// `std_msgs::msg::dds_::String_`; that of a service is without `Request_` and `Response_`. Samples are hex and begin
// with their four bytes of encapsulation; nothing here knows what is in them. FILE and stdin (`-`) hold hex, too.
//
// Prints the line "ready" once its readers and writers exist, "matched" once each has found its counterpart, then:
//
//   read   {"topic", "count", "bytes", "sizes", "first"}   per topic, at the end; `first` is the first sample
//   write  {"topic", "count", "acknowledged"}              at the end; null where nobody acknowledges
//   call   {"service", "reply", "ms", "ignored"}           per call; `ignored` are replies to somebody else
//
// Each side finds the other at its own time, so first samples at best effort may be lost: wait for "matched" on both.
// Fast DDS 2.9 says which sample another one is related to in parameter 0x800f only; later versions add 0x0083.
//
// Exit code: 0, 1 when something did not happen in time (see stderr), 2 for wrong arguments.
//
// g++ -std=c++17 -O1 -o fastdds_peer tests/peers/fastdds_peer.cpp -lfastrtps -lfastcdr

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstring>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/rtps/common/WriteParams.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using Bytes = std::vector<uint8_t>;
using Clock = std::chrono::steady_clock;

const ReturnCode_t OK = ReturnCode_t::RETCODE_OK;
constexpr auto POLL = std::chrono::milliseconds(5);
// How many participants of a domain are found: discovery knocks at the port of each.
constexpr uint32_t PARTICIPANTS = 10;
// What ROS 2 keeps by default, for topics and services alike.
constexpr int DEPTH = 10;

struct Usage : std::runtime_error {
    using runtime_error::runtime_error;
};

class Arguments {
public:
    Arguments(int count, char** words) {
        const std::set<std::string> flags = {"--best-effort", "--reliable", "--transient-local"};
        const std::set<std::string> valued = {
            "--domain", "--seconds", "--topic",  "--type",    "--payload-file", "--count",
            "--rate",   "--depth",   "--expect", "--service", "--request",      "--repeat"};
        for (int i = 2; i < count; ++i) {
            const std::string name = words[i];
            if (!flags.count(name) && !valued.count(name)) throw Usage("what is " + name + "?");
            if (valued.count(name) && i + 1 == count) throw Usage(name + " needs a value");
            values[name] = flags.count(name) ? "" : words[++i];
        }
    }
    bool has(const std::string& name) const { return values.count(name) > 0; }
    std::string text(const std::string& name) const {
        if (!has(name)) throw Usage(name + " is missing");
        return values.at(name);
    }
    double number(const std::string& name, double otherwise) const try {
        return has(name) ? std::stod(text(name)) : otherwise;
    } catch (const std::logic_error&) {
        throw Usage(name + " is not a number");
    }

private:
    std::map<std::string, std::string> values;
};

class Deadline {
public:
    explicit Deadline(double seconds)
        : at(Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))) {}
    bool passed() const { return Clock::now() >= at; }
    void sleep_until(Clock::time_point moment) const { std::this_thread::sleep_until(std::min(moment, at)); }
    eprosima::fastrtps::Duration_t left() const {
        const std::chrono::duration<long double> seconds = at - Clock::now();
        return eprosima::fastrtps::Duration_t(std::max(0.0L, seconds.count()));
    }
    template <typename Condition>
    bool wait_until(Condition condition) const {
        while (!condition() && !passed()) std::this_thread::sleep_for(POLL);
        return condition();
    }

private:
    Clock::time_point at;
};

Bytes from_hex(const std::string& text) {
    std::string digits;
    for (char c : text)
        if (!std::isspace(static_cast<unsigned char>(c))) digits += c;
    if (digits.size() % 2 != 0 || digits.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos)
        throw Usage("not hex");
    Bytes bytes;
    for (size_t i = 0; i < digits.size(); i += 2) bytes.push_back(std::stoi(digits.substr(i, 2), nullptr, 16));
    if (bytes.size() < 4) throw Usage("a sample begins with four bytes of encapsulation");
    return bytes;
}

std::string to_hex(const Bytes& bytes) {
    const char* digits = "0123456789abcdef";
    std::string text;
    for (uint8_t byte : bytes) text += {digits[byte >> 4], digits[byte & 15]};
    return text;
}

void say(const std::string& line) { std::cout << line << std::endl; }

// A sample of any type, as it is on the wire.
class RawType : public fast::TopicDataType {
public:
    explicit RawType(const std::string& name) {
        setName(name.c_str());
        // Only what is allocated at first; histories grow with their samples.
        m_typeSize = 1024;
        m_isGetKeyDefined = false;
        auto_fill_type_object(false);
        auto_fill_type_information(false);
    }
    bool serialize(void* sample, rtps::SerializedPayload_t* payload) override {
        const Bytes& bytes = *static_cast<Bytes*>(sample);
        if (bytes.size() > payload->max_size) return false;
        std::memcpy(payload->data, bytes.data(), bytes.size());
        payload->length = bytes.size();
        payload->encapsulation = bytes[1] == 0 ? CDR_BE : CDR_LE;
        return true;
    }
    bool deserialize(rtps::SerializedPayload_t* payload, void* sample) override {
        static_cast<Bytes*>(sample)->assign(payload->data, payload->data + payload->length);
        return true;
    }
    std::function<uint32_t()> getSerializedSizeProvider(void* sample) override {
        return [sample] { return static_cast<uint32_t>(static_cast<Bytes*>(sample)->size()); };
    }
    void* createData() override { return new Bytes; }
    void deleteData(void* sample) override { delete static_cast<Bytes*>(sample); }
    bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

struct Qos {
    bool reliable = true;
    bool latched = false;
    int depth = DEPTH;

    // Reader's and writer's settings have the same names. As rmw_fastrtps sets them.
    template <typename Endpoint>
    Endpoint of(Endpoint qos) const {
        qos.reliability().kind = reliable ? fast::RELIABLE_RELIABILITY_QOS : fast::BEST_EFFORT_RELIABILITY_QOS;
        qos.durability().kind = latched ? fast::TRANSIENT_LOCAL_DURABILITY_QOS : fast::VOLATILE_DURABILITY_QOS;
        qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
        qos.history().depth = depth;
        qos.resource_limits().max_samples_per_instance =
            std::max(depth, qos.resource_limits().max_samples_per_instance);
        qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
        qos.data_sharing().off();
        return qos;
    }
};

// One participant. Buffers and all else that is not about loopback are Fast DDS's defaults.
class Peer {
public:
    explicit Peer(uint32_t domain) {
        fast::DomainParticipantQos qos = fast::PARTICIPANT_QOS_DEFAULT;
        auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
        transport->interfaceWhiteList = {"127.0.0.1"};
        qos.transport().use_builtin_transports = false;
        qos.transport().user_transports.push_back(transport);
        rtps::Locator_t here;
        rtps::IPLocator::setIPv4(here, "127.0.0.1");
        auto& wire = qos.wire_protocol();
        // With a unicast locator given and no multicast one, discovery uses no multicast. Port 0: the first one free.
        wire.builtin.metatrafficUnicastLocatorList.push_back(here);
        for (uint32_t i = 0; i < PARTICIPANTS; ++i) {
            rtps::Locator_t peer = here;
            peer.port = wire.port.getUnicastPort(domain, i);
            wire.builtin.initialPeersList.push_back(peer);
        }
        participant = made(factory()->create_participant(domain, qos), "participant");
        publisher = made(participant->create_publisher(fast::PUBLISHER_QOS_DEFAULT), "publisher");
        subscriber = made(participant->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT), "subscriber");
    }
    Peer(const Peer&) = delete;
    ~Peer() {
        participant->delete_contained_entities();
        factory()->delete_participant(participant);
    }
    fast::DataReader* reader(const std::string& topic, const std::string& type, const Qos& qos) {
        const auto settings = qos.of(fast::DATAREADER_QOS_DEFAULT);
        return made(subscriber->create_datareader(declared(topic, type), settings), "reader");
    }
    fast::DataWriter* writer(const std::string& topic, const std::string& type, const Qos& qos) {
        const auto settings = qos.of(fast::DATAWRITER_QOS_DEFAULT);
        return made(publisher->create_datawriter(declared(topic, type), settings), "writer");
    }

private:
    static fast::DomainParticipantFactory* factory() { return fast::DomainParticipantFactory::get_instance(); }
    template <typename Entity>
    static Entity* made(Entity* entity, const char* what) {
        if (entity == nullptr) throw std::runtime_error(std::string("Fast DDS made no ") + what);
        return entity;
    }
    fast::Topic* declared(const std::string& topic, const std::string& type) {
        fast::TypeSupport(new RawType(type)).register_type(participant);
        return made(participant->create_topic(topic, type, fast::TOPIC_QOS_DEFAULT), "topic");
    }
    fast::DomainParticipant* participant;
    fast::Publisher* publisher;
    fast::Subscriber* subscriber;
};

bool matched(fast::DataReader* reader) {
    fast::SubscriptionMatchedStatus status;
    reader->get_subscription_matched_status(status);
    return status.current_count > 0;
}

bool matched(fast::DataWriter* writer) {
    fast::PublicationMatchedStatus status;
    writer->get_publication_matched_status(status);
    return status.current_count > 0;
}

// Waits for the next sample with data; false when the time is over.
bool next(fast::DataReader* reader, Bytes& sample, fast::SampleInfo& about, const Deadline& deadline) {
    while (!deadline.passed()) {
        while (reader->take_next_sample(&sample, &about) == OK)
            if (about.valid_data) return true;
        reader->wait_for_unread_message(deadline.left());
    }
    return false;
}

Qos qos_of(const Arguments& arguments) {
    if (arguments.has("--best-effort") && arguments.has("--reliable")) throw Usage("reliable or best effort?");
    const int depth = static_cast<int>(arguments.number("--depth", DEPTH));
    return {!arguments.has("--best-effort"), arguments.has("--transient-local"), depth};
}

// One of the topics that are read, and what came of it.
struct Tally {
    std::string topic;
    fast::DataReader* reader;
    size_t count = 0, bytes = 0;
    std::string sizes;
    Bytes first;

    // Takes everything that is there.
    bool take(size_t most) {
        Bytes sample;
        fast::SampleInfo about;
        bool taken = false;
        while ((most == 0 || count < most) && reader->take_next_sample(&sample, &about) == OK) {
            if (!about.valid_data) continue;
            sizes += (count == 0 ? "" : ",") + std::to_string(sample.size());
            if (count++ == 0) first = sample;
            bytes += sample.size();
            taken = true;
        }
        return taken;
    }

    std::string report() const {
        return "{\"topic\":\"" + topic + "\",\"count\":" + std::to_string(count) + ",\"bytes\":" +
               std::to_string(bytes) + ",\"sizes\":[" + sizes + "],\"first\":\"" + to_hex(first) + "\"}";
    }
};

// Reads one topic, or several with commas between them, all of one type.
void read_topic(Peer& peer, const Arguments& arguments, const Deadline& deadline) {
    const size_t expected = arguments.number("--expect", 0);
    std::vector<Tally> tallies;
    std::istringstream topics(arguments.text("--topic"));
    for (std::string topic; std::getline(topics, topic, ',');)
        tallies.push_back({topic, peer.reader("rt" + topic, arguments.text("--type"), qos_of(arguments))});
    const auto all = [&](auto condition) { return std::all_of(tallies.begin(), tallies.end(), condition); };
    say("ready");
    const bool found = deadline.wait_until([&] { return all([](auto& one) { return matched(one.reader); }); });
    if (found) say("matched");
    const auto complete = [&](const Tally& one) { return expected != 0 && one.count >= expected; };
    while (!deadline.passed() && !all(complete)) {
        bool taken = false;
        for (auto& tally : tallies) taken = tally.take(expected) || taken;
        if (!taken) deadline.sleep_until(Clock::now() + POLL);
    }
    for (const auto& tally : tallies) say(tally.report());
    if (!found) throw std::runtime_error("found no matching writer");
    if (expected != 0 && !all(complete)) throw std::runtime_error("too few samples");
}

void write_topic(Peer& peer, const Arguments& arguments, const Deadline& deadline) {
    const auto topic = arguments.text("--topic"), file = arguments.text("--payload-file");
    std::ifstream opened(file);
    if (file != "-" && !opened) throw Usage("cannot read " + file);
    std::istream& source = file == "-" ? std::cin : opened;
    Bytes sample = from_hex({std::istreambuf_iterator<char>(source), {}});
    const size_t count = arguments.number("--count", 1);
    const double rate = arguments.number("--rate", 10);
    if (rate <= 0) throw Usage("--rate must be above zero");
    const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate));
    const Qos qos = qos_of(arguments);
    auto* writer = peer.writer("rt" + topic, arguments.text("--type"), qos);
    say("ready");
    if (!deadline.wait_until([&] { return matched(writer); })) throw std::runtime_error("found no matching reader");
    say("matched");
    const auto start = Clock::now();
    size_t written = 0;
    for (; written < count && !deadline.passed(); ++written) {
        if (!writer->write(&sample)) throw std::runtime_error("a write failed");
        if (written + 1 < count) deadline.sleep_until(start + (written + 1) * period);
    }
    const bool acknowledged = qos.reliable && writer->wait_for_acknowledgments(deadline.left()) == OK;
    say("{\"topic\":\"" + topic + "\",\"count\":" + std::to_string(written) + ",\"acknowledged\":" +
        (!qos.reliable ? "null" : acknowledged ? "true" : "false") + "}");
    if (written < count) throw std::runtime_error("not all was written in time");
    if (qos.reliable && !acknowledged) throw std::runtime_error("not acknowledged in time");
}

// As rmw_fastrtps's client: a request carries the guid of the reader that awaits the reply, and of the replies on the
// topic, which all clients of the service share, only the one to that guid and to the request's number counts.
void call_service(Peer& peer, const Arguments& arguments, const Deadline& deadline) {
    const auto service = arguments.text("--service"), type = arguments.text("--type");
    Bytes request = from_hex(arguments.text("--request")), reply;
    const size_t repeat = arguments.number("--repeat", 1);
    auto* reader = peer.reader("rr" + service + "Reply", type + "Response_", Qos());
    auto* writer = peer.writer("rq" + service + "Request", type + "Request_", Qos());
    say("ready");
    if (!deadline.wait_until([&] { return matched(reader) && matched(writer); }))
        throw std::runtime_error("found no server of the service");
    say("matched");
    for (size_t i = 0; i < repeat; ++i) {
        rtps::WriteParams identity;
        identity.related_sample_identity().writer_guid() = reader->guid();
        const auto start = Clock::now();
        if (!writer->write(&request, identity)) throw std::runtime_error("the request was not written");
        const auto number = identity.sample_identity().sequence_number();
        fast::SampleInfo about;
        size_t ignored = 0;
        bool answered = false;
        while (!answered && next(reader, reply, about, deadline)) {
            const auto& related = about.related_sample_identity;
            const bool ours = related.writer_guid() == reader->guid() || related.writer_guid() == writer->guid();
            answered = ours && related.sequence_number() == number;
            ignored += !answered;
        }
        const std::chrono::duration<double, std::milli> taken = Clock::now() - start;
        say("{\"service\":\"" + service + "\",\"reply\":" + (answered ? "\"" + to_hex(reply) + "\"" : "null") +
            ",\"ms\":" + std::to_string(taken.count()) + ",\"ignored\":" + std::to_string(ignored) + "}");
        if (!answered) throw std::runtime_error("no reply in time");
    }
}

int main(int count, char** words) try {
    const std::map<std::string, void (*)(Peer&, const Arguments&, const Deadline&)> commands = {
        {"read", read_topic}, {"write", write_topic}, {"call", call_service}};
    const auto command = commands.find(count > 1 ? words[1] : "");
    if (command == commands.end()) throw Usage("read, write or call?");
    const Arguments arguments(count, words);
    arguments.text("--domain");
    const Deadline deadline(arguments.number("--seconds", 10));
    Peer peer(arguments.number("--domain", 0));
    command->second(peer, arguments, deadline);
    return 0;
} catch (const Usage& error) {
    std::cerr << "fastdds_peer: " << error.what() << " (usage: top of its source)" << std::endl;
    return 2;
} catch (const std::exception& error) {
    std::cerr << "fastdds_peer: " << error.what() << std::endl;
    return 1;
}
