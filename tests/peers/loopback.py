"""Keeps CycloneDDS on loopback; to be imported before it, as it reads this when the first participant is made."""

import os

# Loopback has no multicast, so participants look for each other by port.
os.environ["CYCLONEDDS_URI"] = """
<CycloneDDS><Domain Id="any">
  <General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>
    <AllowMulticast>false</AllowMulticast></General>
  <Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>120</MaxAutoParticipantIndex>
    <Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>
"""
