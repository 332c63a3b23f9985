// SPDX-License-Identifier: Apache-2.0
// A Sparkplug host application of Eclipse Tahu: it follows births, data and deaths, puts them in order, asks for births when a message
// is missing, and commands.
//
//   java -cp 'JARS/*' Host.java BROKER ID     asked by lines of JSON, each is answered with a line: {"seen":0}, {"get":[device, metric]},
//                                             {"command":[device, metric, type, value]}, {"rebirth":0}, {"shutdown":0}
import ch.qos.logback.classic.Level;
import com.fasterxml.jackson.databind.JsonNode;
import com.fasterxml.jackson.databind.ObjectMapper;
import java.io.BufferedReader;
import java.io.InputStreamReader;
import java.util.ArrayList;
import java.util.Date;
import java.util.HashMap;
import java.util.LinkedHashMap;
import java.util.List;
import java.util.Map;
import java.util.TreeMap;
import java.util.TreeSet;
import org.eclipse.tahu.host.HostApplication;
import org.eclipse.tahu.host.api.HostApplicationEventHandler;
import org.eclipse.tahu.message.SparkplugBPayloadDecoder;
import org.eclipse.tahu.message.model.DeviceDescriptor;
import org.eclipse.tahu.message.model.EdgeNodeDescriptor;
import org.eclipse.tahu.message.model.Message;
import org.eclipse.tahu.message.model.MessageType;
import org.eclipse.tahu.message.model.Metric;
import org.eclipse.tahu.message.model.Metric.MetricBuilder;
import org.eclipse.tahu.message.model.MetricDataType;
import org.eclipse.tahu.message.model.PropertySet;
import org.eclipse.tahu.message.model.SparkplugBPayload;
import org.eclipse.tahu.message.model.SparkplugDescriptor;
import org.eclipse.tahu.message.model.Topic;
import org.eclipse.tahu.model.MqttServerDefinition;
import org.eclipse.tahu.mqtt.MqttClientId;
import org.eclipse.tahu.mqtt.MqttServerName;
import org.eclipse.tahu.mqtt.MqttServerUrl;
import org.slf4j.LoggerFactory;

public class Host implements HostApplicationEventHandler {
    private static final String NAMESPACE = "spBv1.0", GROUP = "plant", EDGE = "asip";

    private static final Map<String, MetricDataType> TYPES = Map.of("Int64", MetricDataType.Int64, "Double", MetricDataType.Double,
            "Boolean", MetricDataType.Boolean, "String", MetricDataType.String);

    private final Map<String, Map<String, Object>> metrics = new TreeMap<>();  // "device/metric"
    private final TreeSet<String> devices = new TreeSet<>();
    private final List<Long> births = new ArrayList<>(), deaths = new ArrayList<>();  // bdSeq
    private boolean node = false;
    private int deviceDeaths = 0, messages = 0, stale = 0;
    private HostApplication application;

    public static void main(String[] arguments) throws Exception {
        ((ch.qos.logback.classic.Logger) LoggerFactory.getLogger("ROOT")).setLevel(Level.WARN);
        new Host().run(arguments[0], arguments[1]);
    }

    private void run(String broker, String id) throws Exception {
        var server = new MqttServerDefinition(new MqttServerName("broker"), new MqttClientId("tahu-" + id, false), new MqttServerUrl(broker),
                null, null, 10, null);
        application = new HostApplication(this, id, List.of(NAMESPACE + "/#"), List.of(server), null, new SparkplugBPayloadDecoder(), true);
        application.start(true);
        var json = new ObjectMapper();
        var input = new BufferedReader(new InputStreamReader(System.in));
        for (String line = input.readLine(); line != null; line = input.readLine()) {
            var task = json.readTree(line).fields().next();
            var answer = new HashMap<String, Object>();
            try {
                answer.put("value", perform(task.getKey(), task.getValue()));
            } catch (Exception error) {
                answer.put("error", error.toString());
            }
            synchronized (System.out) {
                System.out.println("=" + json.writeValueAsString(answer));
                System.out.flush();
            }
        }
        System.exit(0);
    }

    private Object perform(String task, JsonNode argument) throws Exception {
        switch (task) {
            case "seen":
                synchronized (this) {
                    var seen = new LinkedHashMap<String, Object>();
                    seen.put("node", node);
                    seen.put("devices", new ArrayList<>(devices));
                    seen.put("bdSeqs", new ArrayList<>(births));
                    seen.put("deaths", new ArrayList<>(deaths));
                    seen.put("deviceDeaths", deviceDeaths);
                    seen.put("messages", messages);
                    seen.put("stale", stale);
                    return seen;
                }
            case "get":
                synchronized (this) {
                    var found = metrics.get(argument.get(0).asText() + "/" + argument.get(1).asText());
                    return found == null ? null : new HashMap<>(found);
                }
            case "command":
                var type = TYPES.get(argument.get(2).asText());
                var given = argument.get(3);
                Object value = given.isBoolean() ? (Object) given.asBoolean() : given.isTextual() ? given.asText()
                        : type == MetricDataType.Int64 ? (Object) given.asLong() : (Object) given.asDouble();
                publish(new Topic(NAMESPACE, GROUP, EDGE, argument.get(0).asText(), MessageType.DCMD),
                        new MetricBuilder(argument.get(1).asText(), type, value).createMetric());
                return true;
            case "rebirth":
                publish(new Topic(NAMESPACE, GROUP, EDGE, MessageType.NCMD),
                        new MetricBuilder("Node Control/Rebirth", MetricDataType.Boolean, true).createMetric());
                return true;
            case "shutdown":
                application.shutdown();
                return true;
            default:
                throw new IllegalArgumentException(task);
        }
    }

    private void publish(Topic topic, Metric metric) throws Exception {
        metric.setTimestamp(new Date());
        application.publishCommand(topic, new SparkplugBPayload(new Date(), List.of(metric)));
    }

    private static Long bdSeq(Message message) {
        for (Metric metric : message.getPayload().getMetrics())
            if ("bdSeq".equals(metric.getName())) return ((Number) metric.getValue()).longValue();
        return null;
    }

    private synchronized void take(SparkplugDescriptor of, Metric metric) {
        if (!of.isDeviceDescriptor()) return;
        var known = metrics.computeIfAbsent(of.getDeviceId() + "/" + metric.getName(), name -> new HashMap<>());
        known.put("value", metric.getValue());
        known.put("type", metric.getDataType().toString());
        PropertySet properties = metric.getProperties();
        if (properties == null) return;
        for (var name : properties.getNames())
            known.put("property " + name, properties.getPropertyValue(name).getValue());
    }

    @Override public void onConnect() {}
    @Override public void onDisconnect() {}
    @Override public synchronized void onMessage(SparkplugDescriptor of, Message message) { ++messages; }
    @Override public synchronized void onNodeBirthArrived(EdgeNodeDescriptor of, Message message) {
        births.add(bdSeq(message));
        devices.clear();
        node = true;
    }
    @Override public void onNodeBirthComplete(EdgeNodeDescriptor of) {}
    @Override public void onNodeDataArrived(EdgeNodeDescriptor of, Message message) {}
    @Override public void onNodeDataComplete(EdgeNodeDescriptor of) {}
    @Override public synchronized void onNodeDeath(EdgeNodeDescriptor of, Message message) {
        deaths.add(bdSeq(message));
        devices.clear();
        node = false;
    }
    @Override public void onNodeDeathComplete(EdgeNodeDescriptor of) {}
    @Override public synchronized void onDeviceBirthArrived(DeviceDescriptor of, Message message) { devices.add(of.getDeviceId()); }
    @Override public void onDeviceBirthComplete(DeviceDescriptor of) {}
    @Override public void onDeviceDataArrived(DeviceDescriptor of, Message message) {}
    @Override public void onDeviceDataComplete(DeviceDescriptor of) {}
    @Override public synchronized void onDeviceDeath(DeviceDescriptor of, Message message) {
        ++deviceDeaths;
        devices.remove(of.getDeviceId());
    }
    @Override public void onDeviceDeathComplete(DeviceDescriptor of) {}
    @Override public void onBirthMetric(SparkplugDescriptor of, Metric metric) { take(of, metric); }
    @Override public void onDataMetric(SparkplugDescriptor of, Metric metric) { take(of, metric); }
    @Override public synchronized void onStale(SparkplugDescriptor of, Metric metric) { ++stale; }
}
