"""DDS on the loopback alone, so that no test hears another computer: CYCLONEDDS_URI's value."""

LOOPBACK = ("<CycloneDDS><Domain><General><Interfaces><NetworkInterface name='lo'/></Interfaces>"
            "<AllowMulticast>false</AllowMulticast></General><Discovery>"
            "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>60"
            "</MaxAutoParticipantIndex><Peers><Peer address='127.0.0.1'/></Peers></Discovery>"
            "</Domain></CycloneDDS>")
