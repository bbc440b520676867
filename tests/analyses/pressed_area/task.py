"""The area in a run: it is measured at each load step."""

from fenics_contact.simulation.analysis_tasks import AnalysisFinding, AnalysisTask


class PressedAreaTask(AnalysisTask):
    """Measures it; after a restart the load steps before are not known."""

    missing = "The pressed area was not found"

    def begin(self, problem):
        """No load step is measured yet."""
        self._contacts, self._steps, self._is_whole = problem.contacts, [], True

    def resumed(self):
        """Others were before."""
        self._is_whole = False

    def accepted(self, time, solution):
        """Measure a load step."""
        above = self.scene.pressed_area.above
        parts = [
            contact.trace.integral((state.contact_pressure > above).astype(float))
            for contact, state in zip(self._contacts, solution.states, strict=True)
        ]
        self._steps.append([time, float(sum(parts))])

    def evaluate(self):
        """All of them."""
        record = {"steps": self._steps, "is_whole": self._is_whole}
        words = f" {self._steps[-1][1]:g} of area is pressed hard."
        return AnalysisFinding(further={"pressed_area": record}, words=words)


TASK = PressedAreaTask
