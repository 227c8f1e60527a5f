"""Where the clouds' techniques fail in a picture: the cases of their catalogue."""

from __future__ import annotations

from renderer.core.failure import Failure

FAILURES = (
    Failure(
        name="rayleigh_has_no_fogbow",
        title="Rayleigh's phase function has no fogbow",
        slot="phase",
        failing="rayleigh",
        surviving="mie",
        preset="fogbow",
        symptom="error",
        threshold=0.5,
        measured=(1.24, 0.142),
        cause="Molecules scatter as much back as forward: no bow, and a thin layer sends back far too much.",
    ),
    Failure(
        name="one_lobe_has_no_fogbow",
        title="Henyey and Greenstein's lobe has no fogbow",
        slot="phase",
        failing="henyey_greenstein",
        surviving="mie",
        preset="fogbow",
        symptom="error",
        threshold=0.22,
        measured=(0.295, 0.142),
        cause="One lobe of the right mean cosine falls evenly to the back, where droplets have a bow and a glory.",
    ),
    Failure(
        name="thesis_counts_twice",
        title="Double scattering as the thesis prints it is twice too bright",
        slot="scattering",
        failing="thesis_orders",
        surviving="adding_doubling",
        preset="fogbow",
        symptom="error",
        threshold=0.16,
        measured=(0.181, 0.142),
        cause="Both small turns are counted over the whole path, and with the factor of a single one.",
    ),
    Failure(
        name="single_scattering_is_dark",
        title="Single scattering leaves a cloud dark",
        slot="scattering",
        failing="single",
        surviving="adding_doubling",
        preset="fogbow",
        symptom="error",
        threshold=0.35,
        measured=(0.568, 0.142),
        cause="Even in a layer one free path thick most of the light that it sends back has been scattered often.",
    ),
    Failure(
        name="two_streams_in_a_thin_layer",
        title="Two streams err in a thin layer",
        slot="scattering",
        failing="delta_eddington",
        surviving="adding_doubling",
        preset="fogbow",
        symptom="error",
        threshold=0.21,
        measured=(0.289, 0.142),
        cause="Light leaves a thin layer after one or two turns, and has not spread as a diffuse flux supposes.",
    ),
)
